import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { defineEffect } from '../../gpu/effects/define-effect.ts';
import { reveal } from '../../gpu/effects/reveal/reveal.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import { linkShader } from '../../gpu/shaders/link-shader.ts';
import { compareCulling } from '../../inspect/compare-culling.ts';
import { compareRecords } from '../../inspect/compare-records.ts';
import { describeFieldError } from '../../inspect/field-error.ts';
import { InspectedFrame, type InspectOptions } from '../../inspect/inspected-frame.ts';
import type { ReferenceFunction } from '../../reference/effects/references.ts';
import { compareImages, renderReference } from '../../reference/index.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../testing/test-cameras.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { frameStages } from '../frame-passes.ts';

const SIZE = { widthPx: 48, heightPx: 32 };
const CAMERAS = testCameras(1.5);

const gpu = testGpu();

/** Spheres, with random rotations. */
function balls(options: Parameters<typeof randomSplats>[0]): SplatSet {
  const set = randomSplats({ shDegree: 0, logScales: [-4.5, -2], ...options });
  for (let i = 0; i < set.count; i++) set.logScales.fill(set.logScales[3 * i], 3 * i, 3 * i + 3);
  return set;
}

const flatten = defineEffect({
  name: 'test-flatten',
  label: 'Flatten',
  about: 'Makes disks of splats.',
  hooks: { splat: 'flattenSplat' },
  wgsl: `import package::lib::packing::Splat;
fn flattenSplat(splat: Splat, splatIndex: u32) -> Splat {
  var flat = splat;
  flat.scale.z = 0.01 * splat.scale.z;
  return flat;
}`,
  calledFor: () => 'they are to be flat',
});
const FLATTEN_REFERENCE: Record<string, ReferenceFunction> = {
  'test-flatten': () => ({
    changeSplat: ({ logScales: [x, y, z], ...rest }) => ({ ...rest, logScales: [x, y, z + Math.log(0.01)] }),
  }),
};

/** Draws the clouds, and compares visible splats and records with float64. */
async function drawnAsReference(
  clouds: InspectOptions['clouds'],
  camera: keyof typeof CAMERAS,
  accuracy: InspectOptions['accuracy'] = {},
) {
  const options = { clouds, camera: CAMERAS[camera], accuracy, keyBits: 8, ...SIZE };
  const frame = await InspectedFrame.draw(gpu.device, options);
  const { visibleCount, mismatches, flaws } = await compareCulling(frame);
  expect(flaws).toEqual([]);
  expect(mismatches).toEqual([]);
  const { firstBad } = await compareRecords(frame);
  if (firstBad) expect.fail(describeFieldError(firstBad));
  const { shape } = frame.plan;
  const texts = frameStages(shape)
    .flat()
    .filter((stage) => 'stage' in stage && ['cull-splats', 'project'].includes(stage.stage))
    .map((stage) => linkShader(stage as StageDefinition));
  expect(texts).toHaveLength(2);
  frame.destroy();
  return { visibleCount, shapes: shape.clouds, texts };
}

describe('round splats', () => {
  const set = balls({ count: 700, seed: 80 });
  for (const camera of ['perspective', 'inside', 'orthographic'] as const) {
    for (const geometryPrecision of ['f32', 'packed'] as const) {
      gpuTest(`${camera}, ${geometryPrecision}: as in float64, without a rotation`, async () => {
        const modelMatrix = TEST_MODELS.sheared;
        const drawn = await drawnAsReference([{ set, modelMatrix }], camera, { geometryPrecision });
        expect(drawn.visibleCount).toBeGreaterThan(20);
        expect(drawn.shapes.map((cloud) => cloud.isIsotropic)).toEqual([true]);
        for (const text of drawn.texts) expect(text).not.toMatch(/rotationMatrix|unpackRotation/);
      });
    }
  }

  gpuTest('stay so with effects of this package', async () => {
    const shrink = reveal({ from: [0, 0, 0], radius: 1.2, softEdge: 0.5 });
    const { shapes } = await drawnAsReference([{ set, effects: [shrink] }], 'perspective');
    expect(shapes.map((cloud) => cloud.isIsotropic)).toEqual([true]);
  });

  gpuTest('may become flat by an effect of a caller’s own', async () => {
    const engine = await SplatEngine.create({ device: gpu.device, accuracy: 'high' });
    const view = engine.createView();
    const camera = CAMERAS.perspective;
    const effects = [flatten(undefined)];
    view.render({ camera, clouds: [{ cloud: engine.add(set), effects }], ...SIZE });
    const { data } = await view.readPixels();
    expect(view.shape!.clouds.map((cloud) => cloud.isIsotropic)).toEqual([false]);
    const reference = renderReference({
      clouds: [{ set, effects }],
      effectReferences: FLATTEN_REFERENCE,
      camera,
      ...SIZE,
    });
    expect(compareImages(data, reference.data, SIZE).psnrDb).toBeGreaterThan(60);
    engine.destroy();
  });
});
