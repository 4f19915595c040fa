// Draws cases that the command line cannot, or only in hundreds of processes: every effect, preset
// and setting, and sheared clouds. `node draw-cases.mjs CHECKOUT FOLDER` writes raw float32 images,
// drawn by the checkout's built packages.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const SIZE = { widthPx: 96, heightPx: 64 };
const ASPECT = SIZE.widthPx / SIZE.heightPx;
const MODELS = {
  sheared: [1, 0.3, 0, 0, 0.5, 1, -0.2, 0, 0, 0.4, 0.8, 0, 0, 0, 0.1, 1],
  mirrored: [0.9, 0, 0.2, 0, 0, -0.8, 0, 0, -0.2, 0, 1.1, 0, 0.3, 2, 0, 1],
};

const [checkout, into] = process.argv.slice(2);
const [core, effects, node, scenes] = await Promise.all(
  ['core/dist/index.js', 'core/dist/effects.js', 'node/dist/index.js', 'scenes/dist/index.js'].map(
    (file) => import(pathToFileURL(join(checkout, 'packages', file)).href),
  ),
);
const { gpu, adapter } = await node.createNodeGpu();
const engine = await core.SplatEngine.create({ gpu, adapter });
const errors = [];
engine.device.addEventListener('uncapturederror', (event) => {
  event.preventDefault();
  errors.push(event.error.message);
});
const cameras = camerasAround(scenes.syntheticCamera);
/** Loads a file, so that the engine can read other precisions later. */
const load = async (options) => {
  const ply = new Response(scenes.syntheticPly({ splats: 10_000, ...options }));
  return engine.load(await ply.blob());
};
const cloud = await load({ seed: 1 });

await drawSheared();
for (const [name, uses] of Object.entries(effectCases()))
  for (const camera of ['perspective', 'orthographic'])
    await draw(`effects.${name}.${camera}`, camera, [{ cloud, modelMatrix: MODELS.sheared, effects: uses }]);
for (const [name, accuracy] of accuracyCases()) {
  await engine.setAccuracy(accuracy);
  await draw(`accuracy.${name}`, 'perspective', [{ cloud, modelMatrix: MODELS.mirrored }]);
}
if (errors.length > 0) throw new Error(errors.join('; '));
// Dawn's device would keep the process running.
process.exit(0);

/** Draws in a new view with both rasterizers: the automatic choice depends on measured times. */
async function draw(name, camera, clouds) {
  for (const rasterizer of ['quads', 'tiles']) {
    const view = engine.createView();
    const accuracy = { ...engine.accuracy, rasterizer };
    view.render({ camera: cameras[camera], clouds, ...SIZE, accuracy });
    writeFileSync(join(into, `${name}.${rasterizer}.f32`), (await view.readPixels()).data);
    view.destroy();
  }
}

/** Two overlapping clouds, with every kind of camera. */
async function drawSheared() {
  const other = await load({ seed: 2, shDegree: 1 });
  const clouds = [
    { cloud, modelMatrix: MODELS.sheared },
    { cloud: other, modelMatrix: MODELS.mirrored, opacity: 0.8, shDegree: 0 },
  ];
  for (const camera of Object.keys(cameras)) await draw(`sheared.${camera}`, camera, clouds);
  other.destroy();
}

function camerasAround({ position, target, up, fovYDegrees, near, far }) {
  const place = { position, target, up, aspect: ASPECT, near, far };
  const perspective = core.perspectiveCamera({ ...place, fovYDegrees });
  const projected = (change) =>
    core.cameraFromMatrices(perspective.viewMatrix, Float64Array.from(perspective.projectionMatrix, change), {
      near,
      far,
    });
  return {
    perspective,
    inside: core.perspectiveCamera({ ...place, position: [0.1, 1.1, 0.2], fovYDegrees: 100 }),
    orthographic: core.orthographicCamera({ ...place, height: 3 }),
    'off-centre': projected((value, i) => (i === 8 ? 0.4 : i === 9 ? -0.3 : value)),
    mirrored: projected((value, i) => (i % 4 === 0 ? -value : value)),
  };
}

/** Every effect alone, all together, and a custom one among others. */
function effectCases() {
  const { antialias, brightness, fog, grade, highlight, opacity, reveal, SplatSelection, tint, volumes } =
    effects;
  const selection = new SplatSelection();
  selection.add(Array.from({ length: 3000 }, (_, i) => 3 * i));
  const examples = {
    depthOfField: effects.depthOfField({ aperture: 0.1, focusDistance: 3 }),
    fog: fog({ color: [0.5, 0.6, 0.8], near: 3, far: 12 }),
    tint: tint([1, 0.4, 0.8]),
    volumes: volumes([
      { shape: 'box', mode: 'keep', center: [0.1, 1, 0.1], size: [3, 2, 3], rotation: [0.1, 0.4, -0.2, 0.9] },
      { shape: 'sphere', mode: 'hide', center: [0.4, 1.2, 0.5], radius: 0.4, softEdge: 0.1 },
      { shape: 'plane', mode: 'fade', opacity: 0.3, point: [-0.5, 1, 0], normal: [-2, 0.4, 0] },
      {
        shape: 'capsule',
        mode: 'displace',
        offset: [0, 0.2, 0],
        center: [0, 1, 0],
        radius: 0.3,
        softEdge: 0.2,
      },
      { shape: 'ellipsoid', mode: 'tint', tint: [1.5, 0.6, 0.2], center: [0, 1, 0], size: [1, 2, 1] },
    ]),
    reveal: reveal({ from: [0.3, 1.1, 0.2], radius: 1.5, softEdge: 0.4 }),
    opacity: opacity(0.6),
    antialias: antialias(),
    brightness: brightness(1.8),
    grade: grade({ exposure: 0.4, saturation: 1.5, temperature: -0.6, tint: 0.3 }),
    highlight: highlight({ selection, color: [1, 0.6, 0], strength: 0.7 }),
  };
  const alone = Object.entries(examples).map(([name, use]) => [name, [use]]);
  return {
    none: [],
    ...Object.fromEntries(alone),
    all: Object.values(examples),
    own: [examples.tint, sway()({ by: 0.2 }), examples.volumes],
  };
}

function sway() {
  return effects.defineEffect({
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

/**
 * Every preset, and every other value of every setting; for ranges, both ends and a value between.
 */
function accuracyCases() {
  const standard = core.resolveAccuracy('balanced');
  const presets = Object.keys(core.ACCURACY_PRESETS).map((preset) => [preset, { preset }]);
  const settings = Object.entries(core.ACCURACY_SETTINGS).flatMap(([name, { values }]) => {
    const { min, max } = values;
    const tried = Array.isArray(values) ? values : [min, min + 0.4 * (max - min), max];
    return tried
      .filter((value) => name !== 'rasterizer' && value !== standard[name])
      .map((value) => [`${name}-${value}`, { preset: 'balanced', [name]: value }]);
  });
  return [...presets, ...settings];
}
