import { testCameras } from '../cameras.mjs';
import { effectsOf, noteEngine, picksOf } from '../draw-frame.mjs';
import { drawHostMeshes, withHostDepth } from '../host-meshes.mjs';
import { randomPly } from '../random-ply.mjs';
import { readTexture } from '../read-texture.mjs';

const CONVENTIONS = {
  standard: { compare: 'less-equal', mapping: 'projection' },
  reversed: { compare: 'greater-equal', mapping: 'projection' },
  logarithmic: { compare: 'less-equal', mapping: 'logarithmic' },
};

/** Splats inside another renderer's frame, hidden by its meshes and blended over them. */
export async function embedded({ checkout, size, test, note }) {
  const { core, device } = checkout;
  const engine = await core.SplatEngine.create({ device, accuracy: 'high' });
  const ply = randomPly({ count: 800, seed: 80, logScales: [-4, -1.5] });
  const cloud = await engine.load(ply, { name: 'random' });
  const { perspective, orthographic } = testCameras(core, size.widthPx / size.heightPx);

  /**
   * Asks for a frame until it is prepared and two calls in a row had nothing compiled: before that, a view takes other shaders
   * or none, and it learns a few turns after the device that one of them is compiled.
   */
  async function prepare(view, frame) {
    let isPrepared = false;
    let idleCalls = 0;
    while (idleCalls < 2 || !isPrepared) {
      if (idleCalls === 100) throw new Error('prepare returned false 100 times with all shaders compiled');
      isPrepared = view.prepare(frame);
      const isIdle = !checkout.isCompiling();
      await checkout.compiled();
      idleCalls = isIdle ? idleCalls + 1 : 0;
    }
  }

  async function draw(record, view, { name = '', camera, samples = 1, origin = [0, 0], clouds, ...options }) {
    const { depth = null } = options;
    const seenBy = withHostDepth(core, camera, depth ?? CONVENTIONS.standard);
    const area = { ...size, ...options };
    await prepare(view, { camera: seenBy, clouds: clouds ?? [{ cloud }], ...area });
    const host = drawHostMeshes(device, seenBy, depth ?? CONVENTIONS.standard, { ...area, samples, origin });
    const encoder = device.createCommandEncoder();
    const [xPx, yPx] = origin;
    const composed = view.draw(encoder, { color: host.color, depth: host.depth, xPx, yPx });
    device.queue.submit([encoder.finish()]);
    record.image(`${name}color`, await readTexture(device, composed.color));
    if (composed.depth) record.image(`${name}depth`, await readTexture(device, composed.depth));
    record.value(`${name}effects`, effectsOf(view));
    for (const texture of Object.values(host)) texture.destroy();
  }

  async function drawOnce(record, options) {
    const view = engine.createEmbeddedView();
    await draw(record, view, options);
    record.value('picks', await picksOf(view, size));
    view.destroy();
  }

  for (const [convention, depth] of Object.entries(CONVENTIONS))
    for (const samples of [1, 4])
      for (const writesDepth of [false, true]) {
        const name = [convention, samples > 1 && 'msaa', writesDepth && 'writes-depth']
          .filter(Boolean)
          .join('-');
        await test(name, (record) =>
          drawOnce(record, { camera: perspective, depth, samples, writesDepth, origin: [5, 3] }),
        );
      }
  for (const [convention, depth] of Object.entries(CONVENTIONS))
    await test(`${convention}-orthographic`, (record) =>
      drawOnce(record, { camera: orthographic, depth, writesDepth: true }));
  await test('no-depth', (record) => drawOnce(record, { camera: perspective }));
  for (const samples of [1, 4]) {
    const accuracy = { preset: 'high', resolutionScale: 0.6 };
    await test(`scaled-${samples}-samples`, (record) =>
      drawOnce(record, {
        camera: perspective,
        depth: CONVENTIONS.standard,
        samples,
        accuracy,
        writesDepth: true,
      }));
  }
  await test('one-view', async (record) => {
    const view = engine.createEmbeddedView();
    const { tint } = checkout.effects;
    let options = { camera: perspective, depth: CONVENTIONS.standard, hasOccluders: false };
    const steps = {
      'nothing hides': {},
      'something hides': { hasOccluders: true },
      'depth too': { writesDepth: true },
      moved: { camera: orthographic },
      tinted: { clouds: [{ cloud, effects: [tint([1, 0.3, 0.2])] }] },
      smaller: { widthPx: size.widthPx - 7, heightPx: size.heightPx - 5 },
      'nothing hides again': { hasOccluders: false, writesDepth: false },
    };
    for (const [name, change] of Object.entries(steps)) {
      options = { ...options, ...change };
      await draw(record, view, { ...options, name: `${name}, ` });
    }
    view.destroy();
  });
  noteEngine(note, engine);
  engine.destroy();
}
