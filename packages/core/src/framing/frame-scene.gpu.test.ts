import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterEach, beforeAll, describe, expect, vi } from 'vitest';
import { builderTasks } from '../clouds/geometry-builder.ts';
import { streamLeaves } from '../clouds/leaves/stream-leaves.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { SplatEngine } from '../create-engine.ts';
import { brickSceneOf } from '../data/bricks/make-bricks.ts';
import { mergeSplats } from '../data/editing/merge-splats.ts';
import { transformSplats } from '../data/editing/transform-splats.ts';
import { DestroyedError, SplatSourceError, WebSplatterError } from '../data/errors.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import { followEdits } from '../features/edits/edits.clouds.ts';
import { SplatEdits } from '../features/edits/splat-edits.data.ts';
import { followMorph } from '../features/morph/morph.clouds.ts';
import { SplatMorph } from '../features/morph/splat-morph.data.ts';
import { openLeaves } from '../io/formats/sog/open-leaves.ts';
import { knownSource } from '../io/sources/known-source.ts';
import { fakeWorker } from '../testing/fake-worker.ts';
import { glbBytes, gltfOf, splatAttributes } from '../testing/gltf-fixture.ts';
import { drawComplete, lookFrom, streamContext } from '../testing/look-at-streams.ts';
import { objectScene } from '../testing/object-scene.ts';
import { randomSplats, splatsOf } from '../testing/random-splats.ts';
import { droppedFiles } from '../testing/sog-fixture.ts';
import { streamedSog, streamedSogFiles } from '../testing/streamed-sog-fixture.ts';
import type { FrameSceneOptions } from './frame-clouds.ts';
import { frameScene } from './frame-scene.ts';
import { FRAMING_BUILDERS } from './framing-builder.ts';
import type { SceneFraming } from './scene-framing.ts';

const SET = randomSplats({ count: 1500, shDegree: 0, logScales: [-4, -3] });
/** z up, ten times as large, and moved. */
const MOVED = [10, 0, 0, 0, 0, 0, 10, 0, 0, -10, 0, 0, 100, 200, 300, 1];

let engine: SplatEngine;
beforeAll(async () => {
  engine = await SplatEngine.create({ device: await shareTestDevice() });
});
afterEach(() => vi.unstubAllGlobals());

async function framingOf(cloud: SplatCloud, options?: FrameSceneOptions): Promise<SceneFraming> {
  return (await frameScene([{ cloud }], options))!;
}

function distance(a: Vec3, b: Vec3): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

describe('a framing', () => {
  gpuTest('shows an object as a whole, in the shape and from the angle that are asked for', async () => {
    const cloud = engine.add(await objectScene());
    const framing = await framingOf(cloud);
    expect(framing).toMatchObject({ kind: 'object', up: [0, -1, 0], fovYDegrees: 50 });
    expect(distance(framing.target, [0, 0, 0])).toBeLessThan(0.5);
    expect(await framingOf(cloud, { aspect: 1.6, fovYDegrees: 50 })).toEqual(framing);
    const narrow = await framingOf(cloud, { fovYDegrees: 25, up: [0, -5, 0], kind: 'object' });
    expect(narrow).toMatchObject({ up: [0, -1, 0], confidence: { up: 1 } });
    expect(distance(narrow.position, narrow.target)).toBeGreaterThan(
      1.7 * distance(framing.position, framing.target),
    );
    cloud.destroy();
  });

  gpuTest('moves with its scene, however far', async () => {
    const set = await objectScene(3);
    const near = engine.add(set);
    const far = engine.add(transformSplats(set, { translation: [1e7, -2e7, 3e6] }));
    const framing = await framingOf(near);
    const moved = (await frameScene([{ cloud: near, modelMatrix: MOVED }]))!;
    const [x, y, z] = framing.center;
    expect(distance(moved.center, [100 + 10 * x, 200 - 10 * z, 300 + 10 * y])).toBeLessThan(0.1);
    expect(moved.radius).toBeCloseTo(10 * framing.radius, 1);
    // Up in most files, −y, is −z here.
    expect(moved.up).toEqual([0, 0, -1]);
    const distant = await framingOf(far);
    expect(distance(distant.center, [1e7 + x, -2e7 + y, 3e6 + z])).toBeLessThan(0.01);
    for (const cloud of [near, far]) cloud.destroy();
  });

  gpuTest('has up where the format defines it, in all files', async () => {
    const splats = await objectScene(7);
    const file = new File(
      [glbBytes(gltfOf(splatAttributes({ ...splats, harmonics: SET.harmonics })))],
      'a.glb',
    );
    const defined = await engine.load(file);
    const other = engine.add(splats);
    const upOf = async (...clouds: SplatCloud[]) => {
      const { up } = (await frameScene(clouds.map((cloud) => ({ cloud }))))!;
      return up;
    };
    expect(await upOf(defined)).toEqual([0, 1, 0]);
    expect(await upOf(other, defined)).toEqual([0, -1, 0]);
    for (const cloud of [defined, other]) cloud.destroy();
  });

  gpuTest('follows edits: a part that is hidden or made transparent counts no more', async () => {
    const apart = transformSplats(SET, { translation: [20, 0, 0] });
    const cloud = engine.add(mergeSplats([SET, apart]));
    const edits = new SplatEdits(cloud.count);
    await followEdits(cloud, edits);
    edits.set({ first: 0, count: 1500 }, { visible: false });
    expect(distance((await framingOf(cloud)).center, [20, 0, 0])).toBeLessThan(1);
    edits.set({ first: 0, count: 1500 }, { visible: true });
    edits.set({ first: 1500, count: 1500 }, { opacities: [0] });
    expect(distance((await framingOf(cloud)).center, [0, 0, 0])).toBeLessThan(1);
    edits.set({ first: 0, count: 1500 }, { visible: false });
    expect(await frameScene([{ cloud }])).toBeNull();
    cloud.destroy();
  });

  gpuTest('follows a morph', async () => {
    const precision = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
    const morph = new SplatMorph(SET, transformSplats(SET, { translation: [20, 0, 0] }), precision);
    const cloud = engine.addPacked(morph.packed);
    await followMorph(cloud, morph);
    morph.amount = 0.5;
    expect(distance((await framingOf(cloud)).center, [10, 0, 0])).toBeLessThan(1);
    cloud.destroy();
  });

  gpuTest('counts instances, each as opaque as it is drawn', async () => {
    const cloud = engine.add(SET);
    const at = (x: number) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1];
    const modelMatrices = [...at(0), ...at(1), ...at(50)];
    const centerOf = async (opacities?: number[]) =>
      (await frameScene([{ cloud, instances: { modelMatrices, opacities } }]))!.center[0];
    expect(await centerOf()).toBeLessThan(2);
    expect(await centerOf([0, 0, 1])).toBeGreaterThan(48);
    cloud.destroy();
  });

  gpuTest('is null for scenes in which nothing can be seen', async () => {
    const clear = engine.add(splatsOf([{ opacityLogit: Number.NEGATIVE_INFINITY }]));
    expect(await frameScene([])).toBeNull();
    expect(await frameScene([{ cloud: clear }])).toBeNull();
    expect(await frameScene([{ cloud: clear, opacity: 0 }])).toBeNull();
    clear.destroy();
  });
});

describe('a framing of a scene that streams', () => {
  gpuTest('is the same, whatever bricks are there, and nearly that of all splats', async () => {
    const set = randomSplats({ count: 15_000, seed: 2, shDegree: 0, logScales: [-7, -4] });
    const whole = engine.add(set);
    const cloud = await engine.stream(brickSceneOf(set));
    const first = await framingOf(cloud);
    await drawComplete(engine, cloud);
    expect(cloud.stream!.report().residentBricks).toBeGreaterThan(2);
    expect(await framingOf(cloud)).toEqual(first);
    const all = await framingOf(whole);
    expect(first.kind).toBe(all.kind);
    expect(distance(first.center, all.center)).toBeLessThan(0.1);
    expect(first.radius / all.radius).toBeCloseTo(1, 1);
    for (const each of [whole, cloud]) each.destroy();
  });

  gpuTest('of one brick is that of its splats', async () => {
    const set = randomSplats({ count: 200, shDegree: 0, logScales: [-4, -3] });
    const whole = engine.add(set);
    const cloud = await engine.stream(brickSceneOf(set));
    expect(distance((await framingOf(cloud)).center, (await framingOf(whole)).center)).toBeLessThan(1e-3);
    for (const each of [whole, cloud]) each.destroy();
  });

  gpuTest('tells why its coarse part cannot be read', async () => {
    const scene = brickSceneOf(SET);
    const failure = new SplatSourceError('a.bricks', 'the server is away.');
    const cloud = await engine.stream({
      ...scene,
      read: async (address, signal) => {
        if (address.number > 0) throw failure;
        return scene.read(address, signal);
      },
    });
    await expect(framingOf(cloud)).rejects.toBe(failure);
    cloud.destroy();
  });

  gpuTest('is the same, whatever leaves are there', async () => {
    const set = randomSplats({ count: 3000, seed: 2, shDegree: 0, logScales: [-4, -3] });
    const sog = await streamedSog({ set, filesOfLevel: [4, 2, 1], leafCount: 4 });
    const scene = (await openLeaves(knownSource(droppedFiles(streamedSogFiles(sog, 'scene/')))))!;
    const cloud = await streamLeaves(streamContext(engine.device), scene, {}, {});
    const first = await framingOf(cloud);
    await drawComplete(engine, cloud, { detail: { maxErrorPx: 0.01 } }, lookFrom([0, 0, 2]));
    expect(await framingOf(cloud)).toEqual(first);
    expect(distance(first.center, [0, 0, 0])).toBeLessThan(0.2);
    cloud.destroy();
  });
});

describe('the work of a framing', () => {
  const FakeWorker = fakeWorker(() => builderTasks(FRAMING_BUILDERS));

  gpuTest('is done by a worker, which finds the same', async () => {
    const cloud = engine.add(await objectScene(3));
    const other = engine.add(SET);
    const clouds = [{ cloud }, { cloud: other, modelMatrix: MOVED }];
    const here = await frameScene(clouds);
    vi.stubGlobal('Worker', FakeWorker);
    expect(await frameScene(clouds)).toEqual(here);
    expect(FakeWorker.started.map(({ isTerminated }) => isTerminated)).toEqual([true]);
    FakeWorker.behaviour = 'dies';
    await expect(frameScene(clouds)).rejects.toMatchObject({ code: 'worker-failed' });
    FakeWorker.behaviour = 'works';
    for (const each of [cloud, other]) each.destroy();
  });

  gpuTest('ends with its signal, and with a cloud', async () => {
    const cloud = engine.add(SET);
    const reason = new Error('enough');
    await expect(framingOf(cloud, { signal: AbortSignal.abort(reason) })).rejects.toBe(reason);
    const ending = new AbortController();
    const ended = framingOf(cloud, { signal: ending.signal });
    ending.abort(reason);
    await expect(ended).rejects.toBe(reason);
    const lost = framingOf(cloud);
    cloud.destroy();
    await expect(lost).rejects.toThrow(DestroyedError);
    await expect(framingOf(cloud)).rejects.toThrow(DestroyedError);
  });

  gpuTest('does not begin for options that are none', async () => {
    const cloud = engine.add(SET);
    const wrong = [
      ...[0, -1, Number.NaN, Number.POSITIVE_INFINITY].map((aspect) => ({ aspect })),
      ...[0, 180, Number.NaN].map((fovYDegrees) => ({ fovYDegrees })),
      ...[
        [0, 0, 0],
        [0, Number.NaN, 1],
        [1, 2],
      ].map((up) => ({ up: up as never })),
      { kind: 'portrait' as never },
    ];
    for (const options of wrong) {
      const error = await framingOf(cloud, options).catch((thrown: unknown) => thrown);
      expect(error, JSON.stringify(options)).toMatchObject({ argument: Object.keys(options)[0] });
      expect(error).toBeInstanceOf(WebSplatterError);
    }
    await expect(frameScene([{ cloud, opacity: 2 }])).rejects.toMatchObject({ argument: 'opacity' });
    await expect(frameScene([{ cloud, modelMatrix: [1] }])).rejects.toMatchObject({
      argument: 'modelMatrix',
    });
    cloud.destroy();
  });
});
