import { InvalidArgumentError, type SplatCloud, type SplatSource, SplatSourceError } from '@websplatter/core';
import { openFrames } from '@websplatter/core/frames';
import { splatsFromArrays } from '@websplatter/core/own-data';
import { openFrameWriter } from '@websplatter/core/write';
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { fakeEngine } from '../testing/fake-engine.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';
import { SplatData } from './splat-data.ts';
import { SplatLoader } from './splat-loader.ts';
import { type FrameLoader, inPathOrder, SplatSequence, type SplatSequenceOptions } from './splat-sequence.ts';

interface Load {
  readonly source: string;
  readonly resolve: () => Promise<void>;
  readonly reject: (error: Error) => Promise<void>;
  isEnded: boolean;
}

const { engine } = fakeEngine();
const SOURCES = ['0.ply', '1.ply', '2.ply', '3.ply', '4.ply', '5.ply'];
/** At 10 frames per second. */
const FRAME_MS = 100;

/** Names of the clouds on the GPU. */
const onGpu = new Set<string>();
let cloudBytes = 0;
/** In the order in which they have begun. Tests say when they end. */
let loads: Load[];
let sequences: SplatSequence[] = [];

beforeEach(() => {
  vi.useFakeTimers();
  onGpu.clear();
  cloudBytes = 100;
  loads = [];
});

afterEach(async () => {
  for (const sequence of sequences) sequence.dispose();
  sequences = [];
  await vi.advanceTimersByTimeAsync(0);
  expect(vi.getTimerCount(), 'timers left').toBe(0);
  vi.restoreAllMocks();
  vi.useRealTimers();
});

function dataOf(source: string): SplatData {
  expect(onGpu, 'on the GPU already').not.toContain(source);
  onGpu.add(source);
  const bounds = { min: [0, 0, 0], max: [0, 0, 0] };
  const cloud = {
    count: 1,
    bytes: cloudBytes,
    bounds,
    robustBounds: bounds,
    uploaded: Promise.resolve(),
    destroy: () => expect(onGpu.delete(source)).toBe(true),
  } as unknown as SplatCloud;
  const precision = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
  return new SplatData({ engine, cloud, precision }, source);
}

function fakeLoader(): FrameLoader {
  let abort = () => {};
  const loadAsync = (source: SplatSource) =>
    new Promise<SplatData>((resolve, reject) => {
      const settle = async (end: () => void) => {
        load.isEnded = true;
        end();
        await pass(0);
      };
      const load: Load = {
        source: source as string,
        resolve: () => settle(() => resolve(dataOf(load.source))),
        reject: (error) => settle(() => reject(error)),
        isEnded: false,
      };
      loads.push(load);
      abort = () => void load.reject(new DOMException('aborted', 'AbortError'));
    });
  return { loadAsync, abort: () => abort() } as FrameLoader;
}

async function makeSequence(options: SplatSequenceOptions = {}, sources = SOURCES) {
  const sequence = new SplatSequence(sources, fakeLoader, { framesPerS: 1000 / FRAME_MS, ...options });
  sequences.push(sequence);
  await pass(0);
  return sequence;
}

const pass = (ms: number) => vi.advanceTimersByTimeAsync(ms);
const underWay = () => loads.filter(({ isEnded }) => !isEnded);
const names = (of = loads) => of.map(({ source }) => source);

async function endLoads(): Promise<void> {
  while (underWay().length > 0) await underWay()[0].resolve();
}

/** A cloud that shows a sequence. It begins to draw a frame with `prepare`, as shaders may compile. */
function screenOf(sequence: SplatSequence) {
  const cloud = new SplatCloudObject();
  sequence.addEventListener('change', () => {
    cloud.data = sequence.data;
  });
  const prepare = async () => {
    if (cloud.data) cloud.uploadedTo(engine);
    await pass(0);
  };
  const draw = async () => {
    await prepare();
    if (cloud.data) cloud.announceDrawn(0, []);
    await pass(0);
  };
  return { cloud, prepare, draw };
}

/** Shows `sequence` for some frames, whose loads end at once, and returns the names that it drew. */
async function play(sequence: SplatSequence, frames: number, limit: number): Promise<string[]> {
  const { cloud, prepare, draw } = screenOf(sequence);
  const expectBound = () => expect(onGpu.size + underWay().length).toBeLessThanOrEqual(limit);
  const drawn: string[] = [];
  for (let i = 0; i < frames; i++) {
    while (underWay().length > 0) {
      expectBound();
      await underWay()[0].resolve();
      expectBound();
      await draw();
      expect(onGpu).toContain(cloud.data!.name);
    }
    drawn.push(cloud.data!.name);
    await pass(FRAME_MS);
    expectBound();
    await prepare();
    expectBound();
    await draw();
  }
  return drawn;
}

describe('a sequence', () => {
  test.each([2, 3, 4, 6, 20])('plays all frames in time and again, and holds %i at most', async (limit) => {
    const sequence = await makeSequence({ maxHeldFrames: limit });
    expect(await play(sequence, 14, limit)).toEqual([...SOURCES, ...SOURCES, '0.ply', '1.ply']);
    // What is held is not read again.
    const firstLoads = limit < SOURCES.length ? 14 : SOURCES.length;
    expect(loads.length).toBeGreaterThanOrEqual(firstLoads);
    expect(loads.length).toBeLessThanOrEqual(firstLoads + (limit < SOURCES.length ? limit : 0));
    expect(names().slice(0, 6)).toEqual(SOURCES);
    expect([sequence.droppedFrames, sequence.isBuffering]).toEqual([0, false]);
  });

  test('loads what is needed next, two at a time', async () => {
    const sequence = await makeSequence({ isPlaying: false });
    expect(names()).toEqual(['0.ply', '1.ply']);
    await loads[1].resolve();
    expect(sequence.data).toBeNull();
    await loads[0].resolve();
    expect(sequence.data!.name).toBe('0.ply');
    expect(names()).toEqual(['0.ply', '1.ply', '2.ply', '3.ply']);
  });

  test('reads a file that stands for several frames once', async () => {
    const sequence = await makeSequence({}, ['0.ply', '1.ply', '2.ply', '1.ply']);
    expect(await play(sequence, 8, 4)).toEqual([
      ...['0.ply', '1.ply', '2.ply', '1.ply'],
      ...['0.ply', '1.ply', '2.ply', '1.ply'],
    ]);
    expect(loads).toHaveLength(3);
  });

  test('stays at a frame while the next one is missing, and says so', async () => {
    const sequence = await makeSequence();
    const onChange = vi.fn(() => [sequence.frame, sequence.isBuffering]);
    sequence.addEventListener('change', onChange);
    await loads[0].resolve();
    await pass(5 * FRAME_MS);
    expect([sequence.frame, sequence.isBuffering]).toEqual([0, true]);
    await loads[1].resolve();
    await loads[2].resolve();
    expect([sequence.frame, sequence.isBuffering]).toEqual([1, false]);
    // From here on, time passes as before.
    await pass(FRAME_MS - 1);
    expect(sequence.frame).toBe(1);
    await pass(1);
    expect(onChange.mock.results.map(({ value }) => value)).toEqual([
      [0, false],
      [0, true],
      [1, false],
      [2, false],
    ]);
    expect(sequence.droppedFrames).toBe(0);
  });

  test('drops frames where the page is late, and keeps in time', async () => {
    const sequence = await makeSequence({ maxHeldFrames: 6 });
    await endLoads();
    expect(sequence.frame).toBe(0);
    const now = vi.spyOn(performance, 'now').mockReturnValue(performance.now() + 3.5 * FRAME_MS);
    await pass(FRAME_MS);
    expect([sequence.frame, sequence.droppedFrames]).toEqual([3, 2]);
    now.mockRestore();
  });

  test('reports a frame that cannot be read once, and leaves out its time', async () => {
    const sequence = await makeSequence({ maxHeldFrames: 3 });
    const onError = vi.fn();
    sequence.onError = onError;
    const error = new SplatSourceError('1.ply', 'it is gone');
    await loads[1].reject(error);
    const expected = ['0.ply', '0.ply', '2.ply', '3.ply', '4.ply', '5.ply'];
    expect(await play(sequence, 12, 3)).toEqual([...expected, ...expected]);
    expect(onError.mock.calls).toEqual([[error, 1]]);
    expect(names().filter((name) => name === '1.ply')).toHaveLength(1);
  });

  test('logs errors without a listener, and goes on if nothing can be read', async () => {
    const log = vi.spyOn(console, 'error').mockImplementation(() => {});
    const sequence = await makeSequence({}, ['0.ply', '1.ply']);
    const error = new Error('gone');
    for (const load of underWay()) await load.reject(error);
    expect(log.mock.calls).toEqual([[error], [error]]);
    await pass(5 * FRAME_MS);
    expect([sequence.data, sequence.frame, sequence.isBuffering]).toEqual([null, 0, false]);
  });

  test('stays at the end unless it loops, until a seek', async () => {
    const sequence = await makeSequence({ loop: false, maxHeldFrames: 6 });
    await endLoads();
    await pass(20 * FRAME_MS);
    expect(sequence.frame).toBe(5);
    expect(vi.getTimerCount()).toBe(0);
    sequence.seek({ frame: 4 });
    expect(sequence.frame).toBe(4);
    await pass(FRAME_MS);
    expect(sequence.frame).toBe(5);
    sequence.loop = true;
    await pass(0);
    await endLoads();
    await pass(FRAME_MS);
    expect(sequence.frame).toBe(0);
    sequence.isPlaying = false;
    await pass(5 * FRAME_MS);
    expect(sequence.frame).toBe(0);
    sequence.isPlaying = true;
    sequence.framesPerS = 1;
    await pass(999);
    expect(sequence.frame).toBe(0);
    await pass(1);
    expect(sequence.frame).toBe(1);
  });

  test('without frames does nothing', async () => {
    const sequence = await makeSequence({}, []);
    sequence.seek({ timeS: 1 });
    await pass(FRAME_MS);
    expect([sequence.data, sequence.isBuffering, loads]).toEqual([null, false, []]);
  });
});

describe('a seek', () => {
  test('leads to a frame or a time, and aborts what is not needed any more', async () => {
    const sequence = await makeSequence({ isPlaying: false, maxHeldFrames: 2 });
    await loads[0].resolve();
    sequence.seek({ frame: 4 });
    expect([sequence.frame, sequence.isBuffering]).toEqual([0, true]);
    await pass(0);
    expect(names(loads.filter(({ isEnded }) => isEnded))).toEqual(['0.ply', '1.ply']);
    expect(names(underWay())).toEqual(['4.ply']);
    await endLoads();
    expect([sequence.frame, sequence.data!.name, sequence.isBuffering]).toEqual([4, '4.ply', false]);
  });

  test.each([
    ['the beginning of a frame', 0.3, true, 3],
    ['the middle of a frame', 0.35, false, 3],
    ['beyond the end of a loop', 0.7, true, 1],
    ['before the beginning of a loop', -0.1, true, 5],
    ['beyond the end', 7, false, 5],
    ['before the beginning', -1, false, 0],
  ])('takes %s: %f s', async (_name, timeS, loop, frame) => {
    const sequence = await makeSequence({ isPlaying: false, loop, maxHeldFrames: 6 });
    await endLoads();
    sequence.seek({ timeS });
    expect(sequence.frame).toBe(frame);
  });

  test('takes the beginning of a frame, whatever rounding has made of it', async () => {
    const sequence = await makeSequence({ isPlaying: false, framesPerS: 100, maxHeldFrames: 6 });
    await endLoads();
    expect(0.29 * 100).toBeLessThan(29);
    sequence.seek({ timeS: 0.29 });
    expect(sequence.frame).toBe(29 % SOURCES.length);
  });

  test('back to a frame that is still on the screen reads nothing', async () => {
    const sequence = await makeSequence({ isPlaying: false, maxHeldFrames: 3 });
    const { prepare, draw } = screenOf(sequence);
    await loads[0].resolve();
    await draw();
    sequence.seek({ frame: 3 });
    await pass(0);
    await endLoads();
    await prepare();
    expect([...onGpu]).toEqual(['0.ply', '3.ply', '4.ply']);
    sequence.seek({ frame: 0 });
    await pass(0);
    expect(sequence.data!.name).toBe('0.ply');
    await draw();
    await endLoads();
    expect(names().filter((name) => name === '0.ply')).toHaveLength(1);
    expect([...onGpu]).toEqual(['0.ply', '1.ply', '2.ply']);
  });
});

describe('the pool', () => {
  test('keeps what may be drawn until the next frame is in use', async () => {
    const sequence = await makeSequence({ isPlaying: false, maxHeldFrames: 2 });
    await endLoads();
    sequence.seek({ frame: 1 });
    await endLoads();
    expect([...onGpu]).toEqual(['0.ply', '1.ply']);
    const user = {};
    sequence.data!.acquire(engine, user);
    await pass(0);
    await endLoads();
    expect([...onGpu]).toEqual(['1.ply', '2.ply']);
    sequence.data!.release(user);
    expect([...onGpu]).toEqual(['1.ply', '2.ply']);
  });

  test('frees what is there in spite of an abort', async () => {
    const stubborn = () => ({ ...fakeLoader(), abort: () => ({}) as SplatLoader });
    const sequence = new SplatSequence(SOURCES, stubborn, { isPlaying: false, maxHeldFrames: 2 });
    sequences.push(sequence);
    await pass(0);
    sequence.seek({ frame: 4 });
    expect(names()).toEqual(['0.ply', '1.ply']);
    await loads[0].resolve();
    expect(onGpu.size).toBe(0);
    expect(names()).toEqual(['0.ply', '1.ply', '4.ply']);
  });

  test('holds as many frames as its bytes have room for, and two at least', async () => {
    const sequence = await makeSequence({ isPlaying: false, budgetBytes: 350 });
    await endLoads();
    expect([...onGpu]).toEqual(['0.ply', '1.ply', '2.ply']);
    sequence.dispose();
    cloudBytes = 1000;
    await makeSequence({ isPlaying: false, budgetBytes: 350 });
    await endLoads();
    expect(onGpu.size).toBe(2);
  });

  test('is freed in the middle of loads, but for the frame that a cloud shows', async () => {
    const sequence = await makeSequence();
    const { cloud, draw } = screenOf(sequence);
    await loads[0].resolve();
    await draw();
    await loads[1].resolve();
    expect([...onGpu]).toEqual(['0.ply', '1.ply']);
    const late = underWay()[0];
    sequence.dispose();
    await pass(0);
    expect(underWay()).toEqual([]);
    expect(late.isEnded).toBe(true);
    expect([...onGpu]).toEqual(['0.ply']);
    cloud.dispose();
    expect(onGpu.size).toBe(0);
    const { length } = loads;
    await pass(5 * FRAME_MS);
    expect(loads).toHaveLength(length);
    expect(sequence.data).toBeNull();
  });
});

test.each<[string, (sequence: SplatSequence) => unknown]>([
  ['framesPerS', () => new SplatSequence([], fakeLoader, { framesPerS: 0 })],
  ['framesPerS', () => new SplatSequence([], fakeLoader, { framesPerS: 1e-320 })],
  ['framesPerS', () => new SplatSequence([], fakeLoader, { framesPerS: Number.NaN })],
  ['framesPerS', () => new SplatSequence([], fakeLoader, { framesPerS: 1e9 })],
  ['maxHeldFrames', () => new SplatSequence([], fakeLoader, { maxHeldFrames: 1 })],
  ['budgetBytes', () => new SplatSequence([], fakeLoader, { budgetBytes: 0 })],
  ['frame', (sequence) => sequence.seek({ frame: 6 })],
  ['frame', (sequence) => sequence.seek({ frame: 0.5 })],
  ['timeS', (sequence) => sequence.seek({ timeS: Number.NaN })],
])('refuses a wrong %s', async (argument, use) => {
  const sequence = await makeSequence();
  expect(() => use(sequence)).toThrow(InvalidArgumentError);
  expect(() => use(sequence)).toThrow(`${argument} is `);
});

test('files are put into the order of their paths, numbers by value', () => {
  const file = (name: string, webkitRelativePath = '') => ({ name, webkitRelativePath }) as File;
  const inOrder = inPathOrder([
    file('f10.ply'),
    file('f9.ply'),
    file('1.ply', 'b/1.ply'),
    file('2.ply', 'a/2.ply'),
  ]);
  expect(inOrder.map(({ name }) => name)).toEqual(['2.ply', '1.ply', 'f9.ply', 'f10.ply']);
});

/**
 * @fault Files: frames of a folder have negative numbers
 * @consequence played in the order of their numbers; a hyphen between a word and numbers is no minus
 */
test.each([
  [['-10.ply', '-2.ply', '-1.ply', '0.ply', '1.ply', '10.ply']],
  [['a/-2.ply', 'a/-1.ply', 'a/0.ply', 'b/-3.ply']],
  [['frame_-002.ply', 'frame_-001.ply', 'frame_0000.ply', 'frame_0001.ply']],
  [['frame-2.ply', 'frame-1.ply', 'frame0.ply', 'frame1.ply']],
  [['f −2.ply', 'f −1.ply', 'f 0.ply']],
  [['frame-1.ply', 'frame-2.ply', 'frame-10.ply']],
  [['2024-01-02.ply', '2024-01-10.ply', '2024-02-01.ply']],
  [['take--1.ply', 'take--2.ply']],
])('%s are in order', (paths) => {
  const files = paths.map((path) => ({ name: path, webkitRelativePath: path }) as File);
  expect(inPathOrder(files.toReversed()).map(({ name }) => name)).toEqual(paths);
});

test('frames of one file are played as files are', async () => {
  vi.useRealTimers();
  const writer = await openFrameWriter({ framesPerS: 10 });
  const frameOf = (x: number) =>
    splatsFromArrays({
      positions: [x, 0, 0, x + 1, 1, 1],
      scales: Array(6).fill(0.1),
      rotations: [1, 0, 0, 0, 1, 0, 0, 0],
      opacities: [1, 1],
      colors: Array(6).fill(0.5),
    });
  for (const x of [0, 1, 2, 3]) await writer.add(frameOf(x));
  const parts: Uint8Array<ArrayBuffer>[] = [];
  await writer.finish(async (part) => {
    parts.push(part);
  });
  const { frames, framesPerS, end } = await openFrames(new File(parts, 'dance.frames'));
  const options = { framesPerS, isPlaying: false };
  const sequence = new SplatSequence(frames, () => new SplatLoader(), options);
  sequences.push(sequence);
  const atFrame = async (frame: number) => {
    await expect.poll(() => [sequence.isBuffering, sequence.frame]).toEqual([false, frame]);
    return sequence.data!;
  };
  expect(await atFrame(0)).toMatchObject({ name: 'dance.frames, frame 0', count: 2 });
  sequence.seek({ timeS: 0.2 });
  const { name, bounds } = await atFrame(2);
  expect(name).toBe('dance.frames, frame 2');
  expect(bounds.min.x).toBeCloseTo(2, 2);
  end();
  const errors: unknown[] = [];
  sequence.onError = (error) => errors.push(error);
  sequence.dispose();
  expect(errors).toEqual([]);
  vi.useFakeTimers();
});
