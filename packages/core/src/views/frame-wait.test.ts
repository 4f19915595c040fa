import { describe, expect, test, vi } from 'vitest';
import { internAccuracy } from '../data/accuracy/accuracy.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { FrameShape } from '../frame/plan/frame-shape.ts';
import { signalOf } from '../testing/signal.ts';
import { FrameWait } from './frame-wait.ts';

const shape: FrameShape = {
  clouds: [],
  isOrthographic: false,
  sortsByDistance: false,
  isStacked: false,
  isBudgeted: false,
  accuracy: internAccuracy({ preset: 'balanced', rasterizer: 'quads' }),
  dispatchRow: 65_535,
  sortDevice: { workgroupBytes: 16_384, isNarrow: false, ballots: null },
  visibleCapacity: 100,
  keyBits: 24,
  shortensKeys: false,
  depth: null,
  isFaded: false,
  output: { kind: 'image' },
  rasterizer: 'quads',
  binCount: 0,
};

function planOf(...uploads: Promise<void>[]): FramePlan {
  const clouds = uploads.map((uploaded) => ({ cloud: { uploaded } }));
  return { shape, request: { clouds }, clouds: [] } as unknown as FramePlan;
}

const requestOf = (widthPx: number) => ({ widthPx }) as FrameRequest;

/** A wait for shaders that compile when `compile` is given, or fail with `error`. */
function waitWith(
  retry: (request: FrameRequest | null) => Promise<void> | null = () => null,
  canDrawWithout = () => false,
) {
  const compiled = signalOf();
  const state = { error: null as Error | null };
  const prepare = vi.fn(async () => {
    await compiled.when;
    if (state.error) throw state.error;
  });
  const areReady = vi.fn(() => false);
  const retried = vi.fn(retry);
  const wait = new FrameWait({ prepare, areReady }, retried, canDrawWithout);
  return { wait, prepare, areReady, retried, compiled, state };
}

describe('FrameWait', () => {
  test('draws a request when its shaders are compiled and its clouds are uploaded', async () => {
    const { wait, retried, compiled } = waitWith();
    const uploaded = signalOf();
    const drawn = wait.begin(requestOf(1), 'shaders', () => wait.whenReady(planOf(uploaded.when)));
    expect(wait.reason).toBe('shaders');
    compiled.give();
    await compiled.when;
    expect(retried).not.toHaveBeenCalled();
    uploaded.give();
    await drawn;
    expect(retried.mock.calls).toEqual([[requestOf(1)]]);
    expect(wait.reason).toBeNull();
  });

  test('draws the newest of several requests once, and tells all who wait', async () => {
    const { wait, retried, prepare, compiled } = waitWith();
    const first = wait.begin(requestOf(1), 'shaders', () => wait.whenReady(planOf()));
    const second = wait.begin(requestOf(2), 'shaders', () => wait.whenReady(planOf()));
    compiled.give();
    await Promise.all([first, second]);
    expect(retried.mock.calls).toEqual([[requestOf(2)]]);
    expect(prepare).toHaveBeenCalledTimes(1);
  });

  test('settles only when a request that waits a second time has been drawn', async () => {
    const later = signalOf();
    const { wait, compiled } = waitWith(() => later.when);
    let isDrawn = false;
    const drawn = wait
      .begin(requestOf(1), 'shaders', () => wait.whenReady(planOf()))
      .then(() => {
        isDrawn = true;
      });
    compiled.give();
    await expect.poll(() => wait.reason).toBeNull();
    expect(isDrawn).toBe(false);
    later.give();
    await drawn;
  });

  test('draws no request that another frame has overtaken', async () => {
    const { wait, retried, compiled } = waitWith();
    const drawn = wait.begin(requestOf(1), 'shaders', () => wait.whenReady(planOf()));
    wait.end();
    compiled.give();
    await drawn;
    expect(retried.mock.calls).toEqual([[null]]);
  });

  test('lets a smaller request pass one that looks for memory', async () => {
    const { wait, retried, compiled } = waitWith();
    const room = signalOf();
    const large = wait.begin(requestOf(9), 'memory', () => room.when);
    const small = wait.begin(requestOf(1), 'shaders', () => wait.whenReady(planOf()));
    compiled.give();
    await small;
    expect(retried.mock.calls).toEqual([[requestOf(1)]]);
    room.give();
    await large;
    expect(retried).toHaveBeenLastCalledWith(null);
  });

  test('rejects where a shader does not compile, and lets the next request try again', async () => {
    const { wait, retried, prepare, compiled, state } = waitWith();
    state.error = new Error('no such variant');
    const drawn = wait.begin(requestOf(1), 'shaders', () => wait.whenReady(planOf()));
    compiled.give();
    await expect(drawn).rejects.toBe(state.error);
    expect(wait.reason).toBeNull();
    expect(retried).not.toHaveBeenCalled();
    state.error = null;
    await wait.begin(requestOf(1), 'shaders', () => wait.whenReady(planOf()));
    expect(prepare).toHaveBeenCalledTimes(2);
  });

  test('asks once whether a shape has its shaders, and compiles those that are to follow', () => {
    const { wait, prepare, areReady } = waitWith();
    expect(wait.isReady(shape)).toBe(false);
    expect(prepare).not.toHaveBeenCalled();
    expect(wait.isReadyOrCompiling(shape)).toBe(false);
    expect(prepare).toHaveBeenCalledTimes(1);
    areReady.mockReturnValue(true).mockClear();
    for (let frame = 0; frame < 3; frame++) expect(wait.isReadyOrCompiling(shape)).toBe(true);
    expect([areReady, prepare].map(({ mock }) => mock.calls.length)).toEqual([1, 1]);
  });
});
