import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { internAccuracy } from '../data/accuracy/accuracy.ts';
import { internTarget } from '../data/accuracy/accuracy-target.ts';
import { DestroyedError } from '../data/errors.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import type { TargetOptions } from '../measure/measure-target.ts';
import { AccuracyTargets, type TargetScene, type TargetView } from './accuracy-targets.ts';

const TARGET = internTarget({ minPsnrDb: 45 })!;
const GARDEN = { precisions: { geometry: ['packed'], sh: ['u8'] } } as unknown as SplatCloud;
const BICYCLE = { ...GARDEN } as SplatCloud;

/** A running measurement, to be ended by the test. */
interface Begun extends TargetOptions {
  readonly request: FrameRequest;
  end(settings: AccuracyChoice['settings']): Promise<AccuracyChoice>;
  fail(error: Error): Promise<void>;
}

let begun: Begun[];
let adopted: { readonly choice: AccuracyChoice; readonly clouds: readonly SplatCloud[] }[];
let targets: AccuracyTargets;
const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});

beforeEach(() => {
  vi.useFakeTimers();
  warn.mockClear();
  begun = [];
  adopted = [];
  targets = new AccuracyTargets({
    measure: (target, request, options) =>
      new Promise((resolve, reject) => {
        options.signal.addEventListener('abort', () => reject(options.signal.reason));
        const end = async (settings: AccuracyChoice['settings']) => {
          const choice = { target, settings } as AccuracyChoice;
          resolve(choice);
          await passMs(0);
          return choice;
        };
        const fail = async (error: Error) => {
          reject(error);
          await passMs(0);
        };
        begun.push({ ...options, request, end, fail });
      }),
    adopt: async (choice, clouds) => void adopted.push({ choice, clouds }),
  });
});
afterEach(() => {
  expect(vi.getTimerCount()).toBe(0);
  vi.useRealTimers();
});

/** Lets time pass, and runs the timers and promises that wait for it. */
function passMs(durationMs: number): Promise<unknown> {
  return vi.advanceTimersByTimeAsync(durationMs);
}

function requestOf(clouds: readonly SplatCloud[], widthPx = 64): FrameRequest {
  const instances = clouds.map((cloud) => ({ cloud }));
  return { camera: {} as FrameRequest['camera'], clouds: instances, widthPx, heightPx: 64 };
}

class FakeView implements TargetView {
  readonly told: AccuracyChoice[] = [];
  scene: TargetScene | null = null;

  show(request: FrameRequest, target = TARGET): void {
    const scene = targets.sceneOf(target, request, this.scene?.choice ?? null);
    if (scene !== this.scene) {
      this.leave();
      this.scene = scene;
      scene.join(this);
    }
    scene.onDrawn(this, request);
  }

  leave(): void {
    this.scene?.leave(this);
    this.scene = null;
  }

  onChosen(choice: AccuracyChoice): void {
    this.told.push(choice);
  }
}

describe('when a target is measured', () => {
  test('half a second after the first frame and the last change of a size, the largest of all views', async () => {
    const [small, large] = [new FakeView(), new FakeView()];
    small.show(requestOf([GARDEN], 32));
    await passMs(400);
    large.show(requestOf([GARDEN], 100));
    await passMs(400);
    large.show(requestOf([GARDEN], 128));
    await passMs(499);
    expect(begun).toHaveLength(0);
    await passMs(1);
    expect(begun).toHaveLength(1);
    expect(begun[0].request.widthPx).toBe(128);
    const choice = await begun[0].end(internAccuracy('fast'));
    expect(adopted).toEqual([{ choice, clouds: [GARDEN] }]);
    for (const view of [small, large]) {
      expect(view.told).toEqual([choice]);
      expect(view.scene!.choice).toBe(choice);
    }
    const mirror = new FakeView();
    mirror.show(requestOf([GARDEN], 16));
    await passMs(0);
    expect(mirror.told).toEqual([choice]);
    expect(adopted[1].clouds).toEqual([]);
  });

  test('a moving camera neither delays nor repeats it', async () => {
    const view = new FakeView();
    for (let frame = 0; frame < 10; frame++) {
      view.show(requestOf([GARDEN]));
      await passMs(100);
    }
    expect(begun).toHaveLength(1);
    await begun[0].end(internAccuracy('high'));
    for (let frame = 0; frame < 10; frame++) {
      view.show(requestOf([GARDEN], 64 + frame));
      await passMs(100);
    }
    expect(begun).toHaveLength(1);
    expect(view.told).toHaveLength(1);
  });

  test('again for other clouds, which keep the old choice until then; choices for known clouds stay', async () => {
    const view = new FakeView();
    view.show(requestOf([GARDEN]));
    await passMs(500);
    const first = await begun[0].end(internAccuracy('high'));
    view.show(requestOf([GARDEN, BICYCLE]));
    expect(view.scene!.choice).toBe(first);
    await passMs(500);
    expect(begun[1].previous).toBe(first);
    const second = await begun[1].end(internAccuracy('fast'));
    // The order of the clouds makes no difference.
    view.show(requestOf([BICYCLE, GARDEN]));
    expect(view.scene!.choice).toBe(second);
    view.show(requestOf([GARDEN]));
    expect(view.scene!.choice).toBe(first);
    await passMs(1000);
    // The clouds may hold other planes by now.
    expect(adopted.slice(1)).toEqual([
      { choice: second, clouds: [GARDEN, BICYCLE] },
      { choice: first, clouds: [GARDEN] },
    ]);
    expect(begun).toHaveLength(2);
    expect(targets.latest(TARGET)).toBe(first);
  });

  test('again for another target', async () => {
    const view = new FakeView();
    view.show(requestOf([GARDEN]));
    await passMs(500);
    await begun[0].end(internAccuracy('high'));
    view.show(requestOf([GARDEN]), internTarget({ maxFrameMs: 8 })!);
    expect(view.scene!.choice).toBeNull();
    await passMs(500);
    expect(begun[1].previous).toBeNull();
    await begun[1].end(internAccuracy('fast'));
    expect(view.told).toHaveLength(2);
  });

  test('one after the other', async () => {
    const views = [new FakeView(), new FakeView()];
    views[0].show(requestOf([GARDEN]));
    views[1].show(requestOf([BICYCLE]));
    await passMs(1000);
    expect(begun).toHaveLength(1);
    await begun[0].end(internAccuracy('high'));
    expect(begun).toHaveLength(2);
    await begun[1].end(internAccuracy('fast'));
    expect(views.map(({ told }) => told.length)).toEqual([1, 1]);
  });

  /**
   * @fault Devices and engines: the view leaves that started an accuracy target's timer
   * @consequence the target is met for the other view
   */
  test('also where the view leaves that was drawn first, and the other still waits for its shaders', async () => {
    const [first, compiling] = [new FakeView(), new FakeView()];
    first.show(requestOf([GARDEN]));
    compiling.scene = first.scene;
    first.scene!.join(compiling);
    first.leave();
    await passMs(1000);
    expect(begun).toHaveLength(0);
    compiling.show(requestOf([GARDEN]));
    await passMs(500);
    const choice = await begun[0].end(internAccuracy('fast'));
    expect(compiling.told).toEqual([choice]);
    expect(warn).not.toHaveBeenCalled();
  });

  test('never if nothing is drawn', async () => {
    const view = new FakeView();
    view.show(requestOf([]));
    await passMs(1000);
    expect(begun).toHaveLength(0);
    await expect(view.scene!.choose()).rejects.toThrow('no image yet');
  });
});

describe('on request', () => {
  test('measures at once, cancels the running measurement, and passes the choice to all views', async () => {
    const [view, other] = [new FakeView(), new FakeView()];
    for (const each of [view, other]) each.show(requestOf([GARDEN]));
    await passMs(500);
    const onProgress = vi.fn();
    const choosing = view.scene!.choose({ onProgress });
    await passMs(0);
    expect(begun[0].signal.aborted).toBe(true);
    expect(begun[1].onProgress).toBe(onProgress);
    const choice = await begun[1].end(internAccuracy('fast'));
    expect(await choosing).toBe(choice);
    expect(other.told).toEqual([choice]);
    expect(warn).not.toHaveBeenCalled();
  });

  test('a cancelled measurement changes nothing; a first choice follows automatically', async () => {
    const view = new FakeView();
    view.show(requestOf([GARDEN]));
    const ending = new AbortController();
    const choosing = expect(view.scene!.choose({ signal: ending.signal })).rejects.toThrow('enough');
    await passMs(0);
    ending.abort(new Error('enough'));
    await choosing;
    expect(view.scene!.choice).toBeNull();
    await passMs(500);
    const choice = await begun[1].end(internAccuracy('fast'));
    expect(view.told).toEqual([choice]);
  });
});

describe('the end', () => {
  test('the last view to leave ends the measurement silently', async () => {
    const views = [new FakeView(), new FakeView()];
    for (const view of views) view.show(requestOf([GARDEN]));
    await passMs(500);
    views[0].leave();
    expect(begun[0].signal.aborted).toBe(false);
    views[1].leave();
    expect(begun[0].signal.aborted).toBe(true);
    await passMs(1000);
    expect(begun).toHaveLength(1);
    expect(warn).not.toHaveBeenCalled();
    views[0].show(requestOf([GARDEN]));
    await passMs(500);
    await begun[1].end(internAccuracy('fast'));
    expect(views[0].told).toHaveLength(1);
  });

  test('a withdrawn target is not measured until a view has it again', async () => {
    const [view, idle] = [new FakeView(), new FakeView()];
    for (const each of [view, idle]) each.show(requestOf([GARDEN]));
    await passMs(500);
    targets.withdraw(TARGET);
    await passMs(1000);
    expect(begun.map(({ signal }) => signal.aborted)).toEqual([true]);
    view.show(requestOf([GARDEN]));
    await passMs(500);
    const choice = await begun[1].end(internAccuracy('fast'));
    expect([view.told, idle.told]).toEqual([[choice], []]);
    expect(warn).not.toHaveBeenCalled();
  });

  test('the end of a cloud or of the engine stops its measurements', async () => {
    const views = [new FakeView(), new FakeView()];
    views[0].show(requestOf([GARDEN, BICYCLE]));
    views[1].show(requestOf([BICYCLE]));
    await passMs(500);
    const waiting = expect(views[1].scene!.choose()).rejects.toThrow(DestroyedError);
    targets.stop(new DestroyedError('The cloud', 'it was destroyed'), GARDEN);
    await passMs(0);
    expect(begun.map(({ signal }) => signal.aborted)).toEqual([true, false]);
    targets.stop(new DestroyedError('This measurement', 'the engine was destroyed'));
    await waiting;
    await passMs(1000);
    expect(begun).toHaveLength(2);
    expect(adopted).toEqual([]);
    expect(warn).not.toHaveBeenCalled();
  });

  test('a failed measurement is logged once, and repeated only on request', async () => {
    const view = new FakeView();
    view.show(requestOf([GARDEN]));
    await passMs(500);
    await begun[0].fail(new Error('The reference is broken.'));
    expect(warn.mock.calls).toEqual([
      ['The target {"minPsnrDb":45} could not be measured; images stay. The reference is broken.'],
    ]);
    view.show(requestOf([GARDEN], 128));
    await passMs(1000);
    expect(begun).toHaveLength(1);
    const choosing = view.scene!.choose();
    await passMs(0);
    const choice = await begun[1].end(internAccuracy('fast'));
    expect(await choosing).toBe(choice);
    expect(view.told).toEqual([choice]);
  });
});
