import { effectsOf, imageOfFrame, noteEngine } from '../draw-frame.mjs';
import { randomPly } from '../random-ply.mjs';

/** Above 262,144 splats the engine makes room for those in sight alone, and for more as the camera needs it. */
const SPLATS = 280_000;

export async function largeScene({ checkout, test, note }) {
  const { core, device } = checkout;
  await test('room-for-visible', async (record) => {
    const engine = await core.SplatEngine.create({ device });
    const options = { count: SPLATS, seed: 70, shDegree: 0, logScales: [-7, -5] };
    const cloud = await engine.load(randomPly(options), { name: 'large' });
    const view = engine.createView();
    const fields = { narrow: 12, wide: 60, 'narrow again': 12, wider: 110 };
    for (const [name, fovYDegrees] of Object.entries(fields)) {
      const place = { position: [0.2, 0.1, 0.9], target: [-1, 0.2, -1], aspect: 1.5 };
      const camera = core.perspectiveCamera({ ...place, fovYDegrees, near: 0.05, far: 50 });
      const frame = { camera, clouds: [{ cloud }], widthPx: 24, heightPx: 16 };
      record.image(name, await imageOfFrame(checkout, view, frame));
      note(name, { totalBytes: engine.memory().totalBytes });
    }
    record.value('effects', effectsOf(view));
    noteEngine(note, engine);
    engine.destroy();
  });
}
