import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { GpuLimitError } from '../data/errors.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import { deviceWithoutGpu } from '../testing/device-without-gpu.ts';
import { MemoryRecovery, type RecoveringView } from './memory-recovery.ts';

const LACK = new GpuLimitError('memory', 1000, 0, 'A frame needs 1000 bytes more.', {});

beforeEach(() => {
  vi.stubGlobal('GPUBufferUsage', { COPY_DST: 8 });
});
afterEach(() => {
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

function planOf(
  sizePx: number,
  rasterizer: 'tiles' | 'quads' = 'quads',
  asked: string = rasterizer,
): FramePlan {
  const size = { widthPx: sizePx, heightPx: sizePx };
  return {
    shape: { visibleCapacity: 100, rasterizer, accuracy: { rasterizer: asked } },
    layer: size,
    request: size,
  } as unknown as FramePlan;
}

/** A view whose frames find memory by `checked`, the device's answer; null: nothing allocated. */
function viewWith(members: Partial<RecoveringView> = {}) {
  const state = { parts: { isDestroyed: false }, checked: null as Promise<void> | null, availableBytes: 1e9 };
  const device = deviceWithoutGpu(async () => {});
  const guard = vi.fn((_what: string, _advice: string, work: () => void, _isAlways: boolean) => {
    work();
    return { result: undefined, checked: state.checked };
  });
  const memory = {
    device,
    guard,
    report: () => ({ totalBytes: 500 }),
    get availableBytes() {
      return state.availableBytes;
    },
  };
  const view = {
    parts: () => state.parts,
    startOver: vi.fn(() => {
      recovery.forget();
      state.parts = { isDestroyed: false };
    }),
    rejectTiles: vi.fn(),
    restore: vi.fn(async () => {}),
    drawSuccessor: vi.fn((): Promise<void> | null => null),
    ...members,
  };
  const recovery = new MemoryRecovery(memory as unknown as GpuMemory, view);
  const draw = (plan: FramePlan, checked: Promise<void> | null = null) => {
    state.checked = checked;
    return recovery.draw(plan, () => {});
  };
  return { recovery, view, state, guard, draw };
}

const lacking = () => Promise.reject(LACK);
const isAlways = (guard: ReturnType<typeof viewWith>['guard']) => guard.mock.lastCall?.[3];

describe('a frame', () => {
  test('that takes no more memory than those before is not checked', () => {
    const { draw, recovery } = viewWith();
    expect(draw(planOf(10))).toBeNull();
    expect(recovery.isChecking).toBe(false);
  });

  test('in memory that is still being checked is checked too', async () => {
    const { draw, recovery, guard } = viewWith();
    const first = draw(planOf(10), Promise.resolve());
    expect(isAlways(guard)).toBe(false);
    const second = draw(planOf(11), Promise.resolve());
    expect(isAlways(guard)).toBe(true);
    await Promise.all([first, second]);
    expect(recovery.isChecking).toBe(false);
  });
});

describe('a frame that finds no memory', () => {
  test('is given up: the last sound one is drawn again, and the error is thrown', async () => {
    const { draw, recovery, view } = viewWith();
    const sound = planOf(10);
    await draw(planOf(5), Promise.resolve());
    await draw(sound, Promise.resolve());
    await expect(draw(planOf(20), lacking())).rejects.toBe(LACK);
    expect(view.startOver).toHaveBeenCalledTimes(1);
    expect(view.restore).toHaveBeenCalledExactlyOnceWith(sound);
    expect(view.drawSuccessor).toHaveBeenCalledExactlyOnceWith(null);
    expect(recovery.error).toBe(LACK);
  });

  test('as the first of a view leaves it empty', async () => {
    const { draw, view } = viewWith();
    await expect(draw(planOf(20), lacking())).rejects.toBe(LACK);
    expect(view.restore).not.toHaveBeenCalled();
  });

  test('once it is divided gives way to the frame before', async () => {
    const { draw, recovery, view, state } = viewWith();
    const [before, divided] = [planOf(10), planOf(20)];
    await draw(before, Promise.resolve());
    await draw(divided, Promise.resolve());
    await expect(recovery.giveUp(divided, state.parts, LACK)).rejects.toBe(LACK);
    expect(view.restore).toHaveBeenCalledExactlyOnceWith(before);
  });

  test('takes the frames with it that followed in the same memory', async () => {
    const { draw, view } = viewWith();
    const first = draw(planOf(20), lacking());
    const second = draw(planOf(20), Promise.reject(new Error('invalid buffer')));
    await expect(first).rejects.toBe(LACK);
    await expect(second).rejects.toBe(LACK);
    expect(view.startOver).toHaveBeenCalledTimes(1);
  });

  test('is no error where another request follows it', async () => {
    const { draw, recovery } = viewWith({ drawSuccessor: async () => {} });
    await draw(planOf(20), lacking());
    expect(recovery.error).toBeNull();
  });

  test('rejects with the error of the frame that follows it', async () => {
    const other = new Error('ended');
    const { draw } = viewWith({ drawSuccessor: () => Promise.reject(other) });
    await expect(draw(planOf(20), lacking())).rejects.toBe(other);
  });

  test('is drawn by quads if its tiles were not asked for', async () => {
    const { draw, recovery, view } = viewWith();
    const plan = planOf(20, 'tiles', 'auto');
    await draw(plan, lacking());
    expect(view.rejectTiles).toHaveBeenCalledWith(expect.stringContaining('no memory'), {
      visibleSplats: 100,
      pixels: 400,
    });
    expect(view.drawSuccessor).toHaveBeenCalledExactlyOnceWith(plan);
    expect(recovery.error).toBeNull();
    expect(recovery.lacksRoomFor(plan)).toBe(false);
  });

  test('tells no error once its view is destroyed', async () => {
    const { draw, view, state } = viewWith();
    const drawn = draw(planOf(20), lacking());
    state.parts.isDestroyed = true;
    await drawn;
    expect(view.startOver).not.toHaveBeenCalled();
  });

  test('at once throws, and the last sound one is drawn again where its memory is gone', async () => {
    const { recovery, view, draw, state } = viewWith();
    const sound = planOf(10);
    draw(sound);
    const fail = (isDestroyed: boolean) => () =>
      recovery.draw(planOf(20), () => {
        state.parts = Object.assign(state.parts, { isDestroyed });
        throw LACK;
      });
    expect(fail(false)).toThrow(LACK);
    expect(view.restore).not.toHaveBeenCalled();
    expect(fail(true)).toThrow(LACK);
    expect(view.restore).toHaveBeenCalledExactlyOnceWith(sound);
    // It has been thrown.
    expect(recovery.error).toBeNull();
  });
});

describe('memory that was lacking', () => {
  async function lackingView() {
    const made = viewWith();
    // The lack of memory is what the view is made for.
    await made.draw(planOf(20), lacking())?.catch(() => {});
    return made;
  }

  test('keeps frames from being drawn that need as much, and no smaller ones', async () => {
    const { recovery } = await lackingView();
    expect([19, 20, 21].map((sizePx) => recovery.lacksRoomFor(planOf(sizePx)))).toEqual([false, true, true]);
  });

  test('is looked for at once, and then four times a second', async () => {
    const { recovery, state } = await lackingView();
    const now = vi.spyOn(performance, 'now').mockReturnValue(1000);
    state.availableBytes = 100;
    expect(recovery.isProbeDue).toBe(true);
    await expect(recovery.findRoom()).rejects.toBe(LACK);
    expect(recovery.isProbeDue).toBe(false);
    now.mockReturnValue(1251);
    expect(recovery.isProbeDue).toBe(true);
    state.availableBytes = 1e9;
    await recovery.findRoom();
    expect(recovery.lacksRoomFor(planOf(20))).toBe(false);
    expect(recovery.isProbeDue).toBe(false);
  });
});
