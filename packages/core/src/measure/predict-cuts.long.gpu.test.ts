// Proves: comparing cuts with one another predicts what they are from the full picture.
import { gpuTest, shareBlendingDevice } from '@websplatter/node/gpu-test';
import { syntheticPly } from '@websplatter/scenes';
import { afterAll, beforeAll, expect } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import { MOST_SHARE, predictCertainShare, predictPsnrDb } from '../data/accuracy/cut-curve.ts';
import { perspectiveCamera } from '../data/camera/camera.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import { antialias } from '../gpu/effects/antialias/antialias.ts';
import { readSplats } from '../io/loading/read-splats.ts';
import { objectScene } from '../testing/object-scene.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { stillLife } from '../testing/still-life.ts';
import { compareViews } from './compare-views.ts';
import { predictCuts } from './predict-cuts.ts';

const SIZE = { widthPx: 120, heightPx: 80 };
const VIEWS_PER_SCENE = 12;
/** Of all views, on a slow and busy machine. */
const TIME_LIMIT_MS = 900_000;

interface Scene {
  readonly set: () => Promise<SplatSet<Harmonics>>;
  readonly middle: Vec3;
  readonly radius: number;
}

const SCENES: Readonly<Record<string, Scene>> = {
  'still life': { set: () => stillLife(), middle: [0, 0.25, 0], radius: 0.7 },
  object: { set: () => objectScene(), middle: [0, 0, 0], radius: 1 },
  'random splats': {
    set: async () => randomSplats({ count: 12_000, seed: 5, shDegree: 0, logScales: [-5, -3] }),
    middle: [0, 0, 0],
    radius: 1.5,
  },
  'synthetic scene': {
    set: async () =>
      readSplats(await new Response(syntheticPly({ splats: 16_000, seed: 4, shDegree: 0 })).blob()),
    middle: [0, 1, 0],
    radius: 3,
  },
};

/** A view of half to eight times the radius away, and what is asked for. */
function viewOf({ middle, radius }: Scene, random: () => number) {
  const yaw = 2 * Math.PI * random();
  const pitch = 1.2 * (random() - 0.25);
  const distance = radius * 2 ** (4 * random() - 1);
  const target = middle.map((at) => at + 0.3 * radius * (random() - 0.5)) as [number, number, number];
  const towards = [Math.cos(yaw) * Math.cos(pitch), Math.sin(pitch), Math.sin(yaw) * Math.cos(pitch)];
  const position = target.map((at, axis) => at + distance * towards[axis]) as [number, number, number];
  const fovYDegrees = 30 + 30 * random();
  const camera = perspectiveCamera({ position, target, fovYDegrees, aspect: 1.5, near: 0.01 * radius });
  return { camera, isAntialiased: random() < 0.5, minPsnrDb: 28 + 17 * random() };
}

let engine: SplatEngine;
beforeAll(async () => {
  engine = await SplatEngine.create({ device: await shareBlendingDevice(), accuracy: 'high' });
});
afterAll(() => engine.destroy());

/** PSNR of the cut of this share against the full picture by `reference`, dB. */
async function psnrOf(frame: FrameRequest, maxShare: number): Promise<number> {
  const [cut, full] = [engine.createView(), engine.createView()];
  cut.render({ ...frame, detail: { maxShare } });
  full.render({ ...frame, accuracy: 'reference' });
  const { psnrDb } = await compareViews(cut, full);
  for (const view of [cut, full]) view.destroy();
  return psnrDb;
}

/** By view: predicted PSNR of the first cut that would be drawn, less its PSNR. */
async function errorsDbOf(scene: Scene, seed: number): Promise<readonly number[]> {
  const cloud = engine.add(await scene.set());
  const random = seededRandom(seed);
  const errorsDb: number[] = [];
  for (let i = 0; i < VIEWS_PER_SCENE; i++) {
    const { camera, isAntialiased, minPsnrDb } = viewOf(scene, random);
    const frame = { camera, clouds: [{ cloud, effects: [antialias(isAntialiased)] }], ...SIZE };
    const cuts = await predictCuts(engine, minPsnrDb, frame);
    const share = predictCertainShare(cuts, minPsnrDb);
    const psnrDb = predictPsnrDb(cuts, share);
    // Others are drawn in full.
    if (psnrDb === null || share >= MOST_SHARE) continue;
    errorsDb.push(psnrDb - (await psnrOf(frame, share)));
  }
  cloud.destroy();
  return errorsDb;
}

gpuTest(
  'predicted cuts are within 5 dB in nine of ten views, and too good by three in at most one of twenty',
  async () => {
    const errorsDb: Record<string, readonly number[]> = {};
    for (const [name, scene] of Object.entries(SCENES)) errorsDb[name] = await errorsDbOf(scene, name.length);
    const all = Object.values(errorsDb).flat();
    expect(all.length).toBeGreaterThan(0.75 * VIEWS_PER_SCENE * Object.keys(SCENES).length);
    const shareOf = (isCounted: (errorDb: number) => boolean) => all.filter(isCounted).length / all.length;
    const rounded = Object.entries(errorsDb).map(
      ([name, each]) => `${name}: ${each.map((errorDb) => errorDb.toFixed(1)).join(' ')}`,
    );
    expect(
      shareOf((errorDb) => Math.abs(errorDb) <= 5),
      rounded.join('\n'),
    ).toBeGreaterThanOrEqual(0.9);
    expect(
      shareOf((errorDb) => errorDb > 3),
      rounded.join('\n'),
    ).toBeLessThanOrEqual(0.05);
  },
  TIME_LIMIT_MS,
);
