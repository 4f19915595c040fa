import { context, createRoot } from '@react-three/fiber';
import { findSplatEngine } from '@websplatter/three';
import { act, type ContextType, createElement, type ReactNode, StrictMode } from 'react';
import { renderToString } from 'react-dom/server';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { type SplatSequenceState, type UseSplatSequenceOptions, useSplatSequence } from './sequence.ts';
import type { SplatFileSource } from './splat-cache.ts';

interface Load {
  readonly source: unknown;
  readonly renderer: unknown;
  readonly resolve: () => void;
  readonly reject: (error: Error) => void;
  isAborted: boolean;
}

interface Opening {
  readonly source: unknown;
  readonly signal: AbortSignal;
  readonly resolve: () => void;
  readonly reject: (error: Error) => void;
}

const page = vi.hoisted(() => ({
  loads: [] as Load[],
  openings: [] as Opening[],
  /** Files whose workers have ended. */
  ended: [] as unknown[],
}));

// Here tests say when files are read.
vi.mock('@websplatter/three', () => ({
  SplatCloudObject: class {},
  findSplatEngine: vi.fn(),
  SplatLoader: class {
    #renderer: unknown;
    #load: Load | null = null;
    detectSupport(renderer: unknown) {
      this.#renderer = renderer;
      return this;
    }
    abort() {
      this.#load!.isAborted = true;
    }
    loadAsync(source: unknown) {
      return new Promise((resolve, reject) => {
        const data = { name: source, places: [], isCached: false, dispose() {} };
        this.#load = {
          source,
          renderer: this.#renderer,
          resolve: () => resolve(data),
          reject,
          isAborted: false,
        };
        page.loads.push(this.#load);
      });
    }
  },
}));

vi.mock('@websplatter/core/frames', () => ({
  openFrames: (source: unknown, { signal }: { signal: AbortSignal }) =>
    new Promise((resolve, reject) => {
      const frames = ['0', '1', '2'].map((number) => ({ name: `${source}, frame ${number}` }));
      const opening: Opening = {
        source,
        signal,
        resolve: () => resolve({ frames, framesPerS: 5, end: () => page.ended.push(source) }),
        reject,
      };
      page.openings.push(opening);
    }),
}));

const renderer = { render() {}, setPixelRatio() {}, setSize() {}, dispose() {} };
const SOURCES = ['https://a.test/0.ply', 'https://a.test/1.ply', 'https://a.test/2.ply'];
/** At 10 frames per second. */
const FRAME_MS = 100;

let root: ReturnType<typeof createRoot>;
/** Of the component that calls the hook, in order. */
let results: SplatSequenceState[];

beforeEach(async () => {
  vi.useFakeTimers();
  vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true);
  page.loads.length = 0;
  page.openings.length = 0;
  page.ended.length = 0;
  results = [];
  // three logs that it is imported twice.
  vi.spyOn(console, 'warn').mockImplementation(() => {});
  const canvas = { addEventListener() {}, removeEventListener() {} } as unknown as HTMLCanvasElement;
  root = createRoot(canvas);
  const size = { width: 96, height: 64, top: 0, left: 0 };
  await root.configure({ gl: renderer as never, frameloop: 'never', size, dpr: 1 });
});

afterEach(async () => {
  await act(async () => root.unmount());
  // react-three-fiber disposes of its renderer half a second later.
  await vi.runAllTimersAsync();
  expect(vi.getTimerCount(), 'timers left').toBe(0);
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
  vi.useRealTimers();
});

type Sources = SplatFileSource[] | SplatFileSource;

function Caller({ sources, options }: { sources: Sources; options: UseSplatSequenceOptions }) {
  results.push(useSplatSequence(sources, options));
  return null;
}

/** Shows a sequence, with its list written out anew. */
function show(
  sources: readonly SplatFileSource[] | string,
  options: UseSplatSequenceOptions = {},
  isStrict = false,
) {
  const rates = { framesPerS: 1000 / FRAME_MS, maxHeldFrames: 3, ...options };
  const written = typeof sources === 'string' ? sources : [...sources];
  const caller: ReactNode = createElement(Caller, { sources: written, options: rates });
  return act(async () => root.render(isStrict ? createElement(StrictMode, null, caller) : caller));
}

const pass = (ms: number) => act(async () => void (await vi.advanceTimersByTimeAsync(ms)));
const endLoads = () => act(async () => page.loads.forEach((load) => void load.resolve()));
const shown = () => results.map(({ data, frame, isBuffering }) => [data?.name, frame, isBuffering]);
const latest = () => results.at(-1)!;

it('plays into the Canvas’s renderer, and renders once for each frame', async () => {
  await show(SOURCES);
  expect(results).toEqual([
    {
      data: null,
      frame: 0,
      frameCount: 3,
      isBuffering: true,
      droppedFrames: 0,
      seek: expect.any(Function),
    },
  ]);
  expect(page.loads).toMatchObject([
    { source: SOURCES[0], renderer },
    { source: SOURCES[1], renderer },
  ]);
  await endLoads();
  await endLoads();
  for (let i = 0; i < 3; i++) await pass(FRAME_MS);
  expect(shown()).toEqual([
    [undefined, 0, true],
    [SOURCES[0], 0, false],
    [SOURCES[1], 1, false],
    [SOURCES[2], 2, false],
    [SOURCES[0], 0, false],
  ]);
  expect(new Set(results.map(({ seek }) => seek)).size).toBe(1);
  expect(page.loads).toHaveLength(3);
});

it('loads each file once under StrictMode', async () => {
  await show(SOURCES, {}, true);
  await endLoads();
  await endLoads();
  expect(page.loads.map(({ source }) => source)).toEqual(SOURCES);
  expect(page.loads.some(({ isAborted }) => isAborted)).toBe(false);
  await pass(FRAME_MS);
  expect(latest()).toMatchObject({ frame: 1, data: { name: SOURCES[1] } });
});

it('goes on with an equal list, and follows what may change', async () => {
  await show([new URL(SOURCES[0]), ...SOURCES.slice(1)]);
  await endLoads();
  await endLoads();
  await pass(FRAME_MS);
  await show(SOURCES, { isPlaying: false });
  await pass(5 * FRAME_MS);
  expect(latest().frame).toBe(1);
  await act(async () => latest().seek({ frame: 2 }));
  expect(latest().frame).toBe(2);
  await show(SOURCES, { loop: false });
  await pass(5 * FRAME_MS);
  expect(latest().frame).toBe(2);
  // Without a loop, the frames before were let go of.
  await show(SOURCES, { framesPerS: 1 });
  await endLoads();
  await pass(5 * FRAME_MS);
  expect(latest().frame).toBe(2);
  await pass(5 * FRAME_MS);
  expect(latest().frame).toBe(0);
});

it('begins another list anew, and keeps the last frame of the one before until then', async () => {
  await show(SOURCES);
  await endLoads();
  await pass(FRAME_MS);
  const before = page.loads.length;
  expect(page.loads[2].isAborted).toBe(false);
  await show(['https://b.test/0.ply']);
  expect(page.loads[2].isAborted).toBe(true);
  expect(latest()).toMatchObject({ frame: 0, frameCount: 1, isBuffering: true, data: { name: SOURCES[1] } });
  expect(page.loads.slice(before)).toMatchObject([{ source: 'https://b.test/0.ply' }]);
  await endLoads();
  expect(latest()).toMatchObject({ isBuffering: false, data: { name: 'https://b.test/0.ply' } });
  await show([]);
  expect(latest()).toMatchObject({ frameCount: 0, isBuffering: false, data: null });
  await show(SOURCES);
  expect(latest()).toMatchObject({ frameCount: 3, isBuffering: true, data: null });
});

it('reports errors to the latest listener, or to the console', async () => {
  await show(SOURCES);
  const onError = vi.fn();
  await show(SOURCES, { onError });
  const error = new Error('gone');
  await act(async () => page.loads[1].reject(error));
  expect(onError.mock.calls).toEqual([[error, 1]]);
  const log = vi.spyOn(console, 'error').mockImplementation(() => {});
  await show(SOURCES);
  await act(async () => page.loads[0].reject(error));
  expect(log.mock.calls).toEqual([[error]]);
});

it('aborts its loads when it is unmounted', async () => {
  await show(SOURCES);
  await act(async () => root.render(null));
  expect(page.loads.map(({ isAborted }) => isAborted)).toEqual([true, true]);
});

/** Frames are read once the file of frames is opened, which takes some turns. */
const endOpening = (end: (opening: Opening) => void) =>
  act(async () => {
    await expect.poll(() => page.openings.length).toBeGreaterThan(0);
    end(page.openings.at(-1)!);
  });

it('opens a file of frames, and plays it at its rate unless another is asked for', async () => {
  await show('dance.frames', { framesPerS: undefined });
  expect(latest()).toMatchObject({ data: null, frameCount: 0, isBuffering: true });
  await endOpening(({ resolve }) => resolve());
  expect(page.openings).toMatchObject([{ source: 'dance.frames' }]);
  expect(latest()).toMatchObject({ frameCount: 3, isBuffering: true });
  await endLoads();
  await endLoads();
  expect(page.loads).toMatchObject(
    [0, 1, 2].map((i) => ({ source: { name: `dance.frames, frame ${i}` }, renderer })),
  );
  await pass(199);
  expect(latest()).toMatchObject({ frame: 0, isBuffering: false });
  await pass(1);
  expect(latest().frame).toBe(1);
  await show('dance.frames', { framesPerS: 10 });
  await pass(100);
  expect(latest().frame).toBe(2);
  expect(page.openings).toHaveLength(1);
  const { data } = latest();
  await show(SOURCES);
  expect(page.ended).toEqual(['dance.frames']);
  expect(latest()).toMatchObject({ data, frameCount: 3, isBuffering: true });
});

it('keeps the frame before while another file is opened, and ends the first one', async () => {
  await show('one.frames');
  await endOpening(({ resolve }) => resolve());
  await endLoads();
  const { data } = latest();
  expect(data).not.toBeNull();
  await show('two.frames');
  expect(latest()).toMatchObject({ data, frameCount: 0, isBuffering: true });
  await endOpening(({ resolve }) => resolve());
  await endLoads();
  expect(latest().data).toMatchObject({ name: { name: 'two.frames, frame 0' } });
  expect(page.ended).toEqual(['one.frames']);
});

it('reports a file that cannot be opened, and an opening that comes too late ends', async () => {
  const onError = vi.fn();
  await show('none.frames', { onError });
  const error = new Error('no such file');
  await endOpening(({ reject }) => reject(error));
  expect(onError.mock.calls).toEqual([[error, 0]]);
  expect(latest()).toMatchObject({ data: null, frameCount: 0, isBuffering: false });
  await show('late.frames', { onError });
  await act(async () => expect.poll(() => page.openings.length).toBe(2));
  await act(async () => root.render(null));
  expect(page.openings[1].signal.aborted).toBe(true);
  await endOpening(({ resolve }) => resolve());
  expect(page.ended).toEqual(['late.frames']);
  expect(onError).toHaveBeenCalledTimes(1);
});

it('reads nothing on a server, and refuses renderers that cannot draw splats', () => {
  const caller = createElement(Caller, { sources: SOURCES, options: {} });
  renderToString(caller);
  expect(latest()).toMatchObject({ data: null, isBuffering: true });
  expect(page.loads).toEqual([]);
  const refusal = new Error('no such renderer');
  vi.mocked(findSplatEngine).mockImplementation(() => {
    throw refusal;
  });
  const store = { getState: () => ({ gl: renderer }) } as unknown as ContextType<typeof context>;
  expect(() => renderToString(createElement(context.Provider, { value: store }, caller))).toThrow(refusal);
  vi.mocked(findSplatEngine).mockReset();
});
