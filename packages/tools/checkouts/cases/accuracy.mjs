import { MODELS, testCameras } from '../cameras.mjs';
import { effectsOf, imageOfFrame, noteEngine, picksOf } from '../draw-frame.mjs';
import { randomPly } from '../random-ply.mjs';

/** Every preset, loaded for it and changed to, and every other value of every setting. */
export async function accuracy({ checkout, size, test, note }) {
  const { core, device } = checkout;
  const { perspective: camera } = testCameras(core, size.widthPx / size.heightPx);
  const ply = () => randomPly({ count: 1500, seed: 30 });

  async function draw(record, engine, cloud, accuracyOfFrame) {
    const view = engine.createView();
    const clouds = [{ cloud, modelMatrix: MODELS.mirrored }];
    const frame = { camera, clouds, ...size, accuracy: accuracyOfFrame };
    record.image('image', await imageOfFrame(checkout, view, frame));
    record.value('picks', await picksOf(view, size));
    record.value('effects', effectsOf(view));
    view.destroy();
  }

  for (const preset of Object.keys(core.ACCURACY_PRESETS)) {
    await test(`loaded-for-${preset}`, async (record) => {
      const engine = await core.SplatEngine.create({ device, accuracy: preset });
      await draw(record, engine, await engine.load(ply(), { name: 'random' }));
      record.value('settings', engine.accuracy);
      engine.destroy();
    });
  }

  const engine = await core.SplatEngine.create({ device });
  const cloud = await engine.load(ply(), { name: 'random' });
  for (const preset of Object.keys(core.ACCURACY_PRESETS)) {
    await test(`changed-to-${preset}`, async (record) => {
      const problems = await engine.setAccuracy(preset);
      record.value('problems', problems.length);
      await draw(record, engine, cloud);
    });
    // What the frame asks for and the cloud does not hold is drawn from what it holds.
    await test(`asked-for-${preset}`, async (record) => {
      await engine.setAccuracy('high');
      await draw(record, engine, cloud, preset);
    });
  }
  const settings = core.resolveAccuracy('balanced');
  for (const [name, { values }] of Object.entries(core.ACCURACY_SETTINGS)) {
    for (const value of otherValues(values, settings[name])) {
      await test(`${name}-${value}`, async (record) => {
        const problems = await engine.setAccuracy({ preset: 'balanced', [name]: value });
        record.value('problems', problems.length);
        await draw(record, engine, cloud);
      });
    }
  }
  noteEngine(note, engine);
  engine.destroy();
}

function otherValues(values, current) {
  if (Array.isArray(values)) return values.filter((value) => value !== current);
  const { min, max } = values;
  return [min, min + 0.4 * (max - min), max].filter((value) => value !== current);
}
