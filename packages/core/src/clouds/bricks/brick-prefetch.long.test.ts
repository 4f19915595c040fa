import { afterEach, expect, test, vi } from 'vitest';
import type { Brick, BrickAddress, BrickCell, BrickScene } from '../../data/bricks/brick.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { nextTask } from '../../data/turns.ts';
import { FakeBrickPool } from '../../testing/fake-brick-pool.ts';
import { sightFrom } from '../../testing/sight-from.ts';
import type { CloudSight } from '../stream/cloud-sight.ts';
import { SceneStream } from '../stream/scene-stream.ts';
import { SightPrediction } from '../stream/sight-prediction.ts';
import { BrickParts } from './brick-parts.ts';
import { BrickPlan } from './brick-plan.ts';
import type { BrickPool } from './brick-pool.ts';

const FRAME_MS = 16;
const FRAMES = 250;
/** Of each brick. */
const LATENCY_MS = 200;
/** Metres of a side of the scene, a square in four levels of bricks, whose cells are 32, 8, 2 and 0.5 m wide. */
const SIDE_M = 128;
const LEVELS = 4;

afterEach(() => {
  vi.restoreAllMocks();
  vi.useRealTimers();
});

/** The code of an error, as in links. */
function codeOf(errorM: number): number {
  const bits = new DataView(new ArrayBuffer(4));
  bits.setFloat32(0, errorM ** 2);
  return bits.getUint32(0) >>> LEVEL_CONSTANTS.ERROR_SHIFT;
}

/** Bricks of a plane, each of which divides a square into sixteen. */
function squareScene(): { scene: BrickScene; reads: () => number } {
  const firsts = [0, 1, 17, 273];
  const places = new Map<number, { x: number; z: number; size: number; level: number }>();
  let reads = 0;
  const address = (number: number): BrickAddress => ({ number, offset: 200_000 * number, bytes: 150_000 });
  const visit = (number: number, x: number, z: number, size: number, level: number) => {
    places.set(number, { x, z, size, level });
    if (level === 0) return;
    const depth = LEVELS - 1 - level;
    for (let i = 0; i < 16; i++) {
      const child = firsts[depth + 1] + 16 * (number - firsts[depth]) + i;
      visit(child, x + (size / 4) * (i % 4), z + (size / 4) * Math.floor(i / 4), size / 4, level - 1);
    }
  };
  visit(0, -SIDE_M / 2, -SIDE_M / 2, SIDE_M, LEVELS - 1);
  const brickOf = (number: number): Brick => {
    const { x, z, size, level } = places.get(number)!;
    const depth = LEVELS - 1 - level;
    const width = size / 4;
    const cells = Array.from({ length: 16 }, (_, i): BrickCell => {
      const [left, near] = [x + width * (i % 4), z + width * Math.floor(i / 4)];
      return {
        bounds: { min: [left, -1, near], max: [left + width, 1, near + width] },
        largestScale: 0.01,
        leafCount: 256,
        logScales: [0, 0],
        child: level > 0 ? address(firsts[depth + 1] + 16 * (number - firsts[depth]) + i) : null,
        childErrors: level > 0 ? [codeOf(width / 20)] : [],
        childRoots: [],
      };
    });
    const none = new Uint32Array(0);
    return { level, cells, geometry: none, harmonics: none, fileIndices: none };
  };
  const bounds = { min: [-64, -1, -64], max: [64, 1, 64] } as const;
  const scene: BrickScene = {
    name: 'a plane',
    splatCount: 4096 * 4096,
    brickCount: places.size,
    shDegree: 0,
    origin: [0, 0, 0],
    bounds,
    robustBounds: bounds,
    root: address(0),
    read: async ({ number }, signal) => {
      reads++;
      if (number > 0) await new Promise<void>((resolve) => setTimeout(resolve, LATENCY_MS));
      signal?.throwIfAborted();
      return brickOf(number);
    },
    end: () => {},
  };
  return { scene, reads: () => reads };
}

type Path = (seconds: number) => CloudSight;

const walk: Path = (s) => {
  const x = -50 + 4 * s;
  const z = 6 * Math.sin(0.3 * s);
  return sightFrom([x, 1.5, z], [x + 1, 1.4, z + 1.8 * Math.cos(0.3 * s)]);
};
const orbit: Path = (s) => sightFrom([9 * Math.cos(0.6 * s), 4, 9 * Math.sin(0.6 * s)], [0, 0, 0]);
/** Moves along a path, and stops at its end. */
async function follow(path: Path, slots: number) {
  vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] });
  const pool = new FakeBrickPool({ lowest: slots, upper: slots });
  const { scene, reads } = squareScene();
  const root = pool.place(await scene.read(scene.root), scene.root, null);
  const stream = new SceneStream(new BrickParts(scene, pool as unknown as BrickPool, root));
  const step = async (seconds: number) => {
    stream.setSights(stream, [path(seconds)], async () => {});
    stream.onFrame();
    await nextTask();
  };
  const rest = async () => {
    while (stream.complete) await vi.advanceTimersByTimeAsync(FRAME_MS);
  };
  await step(0);
  await rest();
  const before = reads();
  let missing = 0;
  for (let frame = 1; frame <= FRAMES; frame++) {
    await vi.advanceTimersByTimeAsync(FRAME_MS);
    await step((frame * FRAME_MS) / 1000);
    const { missingBricks, refusedBricks } = stream.report();
    missing += missingBricks - refusedBricks;
  }
  const fetched = reads() - before;
  await rest();
  const demand = new BrickPlan([path((FRAMES * FRAME_MS) / 1000)]);
  const drawn = pool.bricks.filter(({ above }) => above && demand.valueOf(above) > 1);
  const report = stream.report();
  stream.end();
  vi.useRealTimers();
  return {
    missing: missing / FRAMES,
    fetched,
    report,
    drawn: new Set(drawn.map(({ address }) => address.number)),
  };
}

/** The same, where nothing is predicted. */
async function followBlindly(path: Path, slots: number) {
  const predict = vi.spyOn(SightPrediction.prototype, 'predict').mockReturnValue([]);
  const found = await follow(path, slots);
  predict.mockRestore();
  return found;
}

test.each([
  { name: 'a walk', path: walk },
  { name: 'an orbit', path: orbit },
])('on $name, frames lack half of what they would if no motion was foreseen', async ({ path }) => {
  const [found, blind] = [await follow(path, 60), await followBlindly(path, 60)];
  expect(found.missing).toBeLessThan(blind.missing / 2);
  expect(found.fetched).toBeLessThan(1.2 * blind.fetched);
  expect(found.report).toMatchObject({ isComplete: true, missingBricks: 0 });
  expect(found.drawn).toEqual(blind.drawn);
});

test('what is foreseen takes no room from what is drawn', async () => {
  const [found, blind] = [await follow(walk, 25), await followBlindly(walk, 25)];
  expect(found.report.refusedBricks).toBeGreaterThan(0);
  expect(found.missing).toBeLessThanOrEqual(blind.missing);
  expect(found.drawn).toEqual(blind.drawn);
});
