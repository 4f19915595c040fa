import { MODELS, testCameras } from '../cameras.mjs';
import { effectsOf, imageOfFrame, noteEngine } from '../draw-frame.mjs';
import { randomPly } from '../random-ply.mjs';

/** Every effect alone, all together, and one of a caller's own. */
export async function effects({ checkout, size, test, note }) {
  const { core, device } = checkout;
  const engine = await core.SplatEngine.create({ device, accuracy: 'high' });
  const cloud = await engine.load(randomPly({ count: 1200, seed: 60, shDegree: 1 }), { name: 'random' });
  const view = engine.createView();
  const cameras = testCameras(core, size.widthPx / size.heightPx);

  async function draw(record, uses, only = {}) {
    for (const name of ['perspective', 'orthographic']) {
      const clouds = [{ cloud, modelMatrix: MODELS.sheared, effects: uses, ...only }];
      record.image(name, await imageOfFrame(checkout, view, { camera: cameras[name], clouds, ...size }));
    }
    record.value('effects', effectsOf(view));
  }

  const examples = examplesOf(checkout.effects);
  await test('none', (record) => draw(record, []));
  for (const [name, use] of Object.entries(examples)) await test(name, (record) => draw(record, [use]));
  await test('all', (record) => draw(record, Object.values(examples)));
  await test('own', (record) => draw(record, [ownEffect(checkout.effects)({ by: 0.2 })]));
  await test('own-among-others', (record) => {
    const { clip, tint } = examples;
    return draw(record, [tint, ownEffect(checkout.effects)({ by: -0.1 }), clip]);
  });
  await test('opacity-and-degree', (record) => draw(record, [], { opacity: 0.4, shDegree: 0 }));
  await test('selection-changes', async (record) => {
    const selection = new checkout.effects.SplatSelection();
    const use = checkout.effects.highlight({ selection, color: [1, 0, 0], strength: 1 });
    const steps = {
      empty: () => {},
      some: () => selection.add(Array.from({ length: 300 }, (_, i) => 4 * i)),
      fewer: () => selection.delete(Array.from({ length: 100 }, (_, i) => 8 * i)),
      cleared: () => selection.clear(),
    };
    for (const [name, change] of Object.entries(steps)) {
      change();
      const clouds = [{ cloud, effects: [use] }];
      const frame = { camera: cameras.perspective, clouds, ...size };
      record.image(name, await imageOfFrame(checkout, view, frame));
    }
  });
  noteEngine(note, engine);
  engine.destroy();
}

/** Uses that change an image of a cloud within ±1 of the origin, in the order in which they are asked for together. */
function examplesOf({ antialias, brightness, clip, fog, highlight, opacity, reveal, SplatSelection, tint }) {
  const selection = new SplatSelection();
  selection.add(Array.from({ length: 400 }, (_, i) => 3 * i));
  return {
    fog: fog({ color: [0.5, 0.6, 0.8], near: 0.5, far: 3 }),
    tint: tint([1, 0.4, 0.8]),
    clip: clip({
      volumes: [
        { shape: 'box', center: [0.1, 0, 0.1], size: [2, 1.5, 2], rotation: [0.1, 0.4, -0.2, 0.9] },
        { shape: 'sphere', center: [0.4, 0.2, 0.5], radius: 0.3, keep: 'outside' },
        { shape: 'plane', point: [-0.5, 0, 0], normal: [2, 0.4, 0] },
      ],
      softEdge: 0.1,
    }),
    reveal: reveal({ from: [0.3, 0.1, 0.2], radius: 1, softEdge: 0.4 }),
    opacity: opacity(0.6),
    antialias: antialias(),
    brightness: brightness(1.8),
    highlight: highlight({ selection, color: [1, 0.6, 0], strength: 0.7 }),
  };
}

/** Moves every splat, as a caller of the package may define it. */
function ownEffect({ defineEffect }) {
  return defineEffect({
    name: 'compared-sway',
    label: 'Sway',
    about: 'Moves everything along x.',
    hooks: { splat: 'swaySplat' },
    wgsl: `import package::lib::packing::Splat;
import parameters::ComparedSway;
fn swaySplat(splat: Splat, splatIndex: u32, parameters: ComparedSway) -> Splat {
  var moved = splat;
  moved.position.x += parameters.by;
  return moved;
}`,
    fields: { by: 'f32' },
    calledFor: ({ by }) => (by === 0 ? null : 'there is wind'),
    valuesAt: ({ by }) => ({ by }),
    reach: ({ by }) => ({ displacement: Math.abs(by), growth: 1 }),
  });
}
