import { existsSync, openAsBlob } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { MODELS, testCameras } from '../cameras.mjs';
import { drawFrame, effectsOf, imageOfFrame, noteEngine, picksOf } from '../draw-frame.mjs';
import { randomPly } from '../random-ply.mjs';

/** Whole scenes in the engine's own accuracy: the built-in one, a scanned one, and clouds that overlap. */
export async function scenes({ checkout, size, playbot, test, note }) {
  const { core, scenes: builtin, device } = checkout;
  const engine = await core.SplatEngine.create({ device });
  const aspect = size.widthPx / size.heightPx;

  async function views(clouds, cameras, record) {
    const view = engine.createView();
    for (const [name, camera] of Object.entries(cameras)) {
      record.image(name, await imageOfFrame(checkout, view, { camera, clouds, ...size }));
      record.value(`${name} effects`, effectsOf(view));
    }
    record.value('picks', await picksOf(view, size));
    view.destroy();
  }

  await test('still-life', async (record) => {
    const scene = builtin.builtinScenes.find(({ name }) => name === 'still-life-small');
    const cloud = await engine.load(await openAsBlob(fileURLToPath(scene.url)), { name: scene.name });
    const [front, bowl] = ['front', 'bowl'].map((wanted) =>
      scene.cameras.find(({ name }) => name === wanted),
    );
    const cameras = {
      orthographic: core.orthographicCamera({ ...front, aspect, height: 1.1 }),
      front: core.perspectiveCamera({ ...front, aspect }),
      bowl: core.perspectiveCamera({ ...bowl, aspect }),
    };
    await views([{ cloud }], cameras, record);
    cloud.destroy();
  });

  await test('playbot-lod3', async (record) => {
    if (playbot === null || !existsSync(playbot)) {
      record.skipped(`there is no ${playbot ?? 'file: name it with --playbot'}`);
      return;
    }
    const cloud = await engine.load(await openAsBlob(playbot), { name: 'playbot-lod3' });
    const { min, max } = cloud.robustBounds;
    const target = min.map((low, axis) => (low + max[axis]) / 2);
    const radius = Math.hypot(...min.map((low, axis) => max[axis] - low)) / 2;
    const from = (x, y, z) => ({
      position: [target[0] + x * radius, target[1] + y * radius, target[2] + z * radius],
      target,
      aspect,
      near: 0.01 * radius,
      far: 100 * radius,
    });
    const cameras = {
      far: core.perspectiveCamera({ ...from(0.9, 0.6, 1.8), fovYDegrees: 45 }),
      near: core.perspectiveCamera({ ...from(-0.6, 0.1, 0.4), fovYDegrees: 60 }),
      orthographic: core.orthographicCamera({ ...from(-1, 1, 1.5), height: 1.6 * radius }),
    };
    await views([{ cloud }], cameras, record);
    cloud.destroy();
  });

  await test('sheared', async (record) => {
    const load = (name, options) => engine.load(randomPly({ count: 1500, ...options }), { name });
    const first = await load('sheared', { seed: 11 });
    const second = await load('mirrored', { seed: 12, shDegree: 1 });
    const clouds = [
      { cloud: first, modelMatrix: MODELS.sheared },
      { cloud: second, modelMatrix: MODELS.mirrored, opacity: 0.8 },
    ];
    await views(clouds, testCameras(core, aspect), record);
    for (const cloud of [first, second]) cloud.destroy();
  });

  await test('nothing held', async (record) => {
    const before = engine.memory().totalBytes;
    const cloud = await engine.load(randomPly({ count: 300 }), { name: 'for a while' });
    const view = engine.createView();
    await drawFrame(checkout, view, {
      camera: testCameras(core, aspect).inside,
      clouds: [{ cloud }],
      ...size,
    });
    view.destroy();
    cloud.destroy();
    record.value('bytes left', engine.memory().totalBytes - before);
  });

  noteEngine(note, engine);
  engine.destroy();
}
