import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { SkinParameters } from '../../data/layout/packing-structs.ts';
import { chunksOf, logScalesOf, setLogScales } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, type PackedGeometry, packGeometry } from '../../data/packing/geometry.ts';
import { logScaleRange } from '../../data/packing/log-scale.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { rotationMatrix } from '../../reference/covariance.ts';
import { type ReferenceSplat, unpackSplat } from '../../reference/packing.ts';
import { dispatchSize } from '../../stages/dispatch.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { skinGeometry as reference } from './skin.reference.ts';
import { skinGeometry } from './skin.stages.ts';
import { SplatSkin } from './splat-skin.data.ts';

const gpu = testGpu();

const COUNT = 700;
const DISPATCH_ROW = 2;
/** Rows of joints' matrices: at rest, turned, turned and sheared, mirrored, flat. */
const JOINTS = [
  [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0],
  [0.36, 0.48, -0.8, 1, -0.8, 0.6, 0, 0.2, 0.48, 0.64, 0.6, -2],
  [1.5, 0.7, 0, 0, 0, 0.5, 0.3, 3, -0.4, 0, 2, 0],
  [-1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0],
  [1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0],
];
const SET = randomSplats({ count: COUNT, shDegree: 0, seed: 61, logScales: [-9, 0] });
// Balls, rods, discs and points.
for (const [row, logScales] of [
  [-3, -3, -3],
  [0, -9, -9],
  [-1, -1, -30],
  [-200, -200, -200],
].entries())
  SET.logScales.set(logScales, 3 * row);
/** The flat joint alone moves this row, whose first axis is the one that the joint takes away. */
const FLAT_ROW = 6;
SET.rotations.fill(0.5, 4 * FLAT_ROW, 4 * FLAT_ROW + 4);

function skinOf(jointCount = JOINTS.length): SplatSkin {
  const random = seededRandom(5);
  const indices = Array.from({ length: 4 * COUNT }, () => Math.floor(jointCount * random()));
  indices[4 * FLAT_ROW] = 4;
  // Some rows follow one joint alone.
  const weights = Array.from({ length: 4 * COUNT }, (_, k) => (k % 12 < 4 && k % 4 > 0 ? 0 : random()));
  return new SplatSkin({ indices, weights }, jointCount);
}

async function skinOnGpu(precision: GeometryPrecision, skin = skinOf(), shaders = gpu.pipelines) {
  const restChunks = chunksOf(SET);
  const rest = packGeometry(SET, precision, restChunks);
  const chunks = restChunks.slice();
  for (let chunk = 0; chunk < COUNT / CHUNK_SPLATS; chunk++) {
    const { min, step } = logScalesOf(restChunks, chunk);
    setLogScales(chunks, chunk, logScaleRange(Math.max(-40, min - 3), min + 65535 * step + 1));
  }
  const skinned = gpu.storage([], 4 * COUNT * GEOMETRY_WORDS[precision]);
  const bindings = {
    parameters: gpu.uniform(SkinParameters.pack({ splatCount: COUNT, dispatchRow: DISPATCH_ROW })),
    rest: gpu.storage(rest.words),
    skinned,
    influences: gpu.storage(skin.words),
    joints: gpu.storage(new Uint32Array(Float32Array.from(JOINTS.flat()).buffer)),
    restChunks: gpu.storage(restChunks),
    chunks: gpu.storage(chunks),
  };
  const workgroups = dispatchSize(Math.ceil(COUNT / CHUNK_SPLATS), DISPATCH_ROW);
  await gpu.run(skinGeometry(precision), bindings, workgroups, shaders);
  const made: PackedGeometry = { precision, chunks, words: await gpu.read(skinned) };
  return { made, expected: reference(rest, skin.words, JOINTS.flat(), COUNT) };
}

function covarianceOf({ rotation, scale }: ReferenceSplat): number[] {
  const turn = rotationMatrix(...rotation);
  return [0, 1, 2].flatMap((row) =>
    [0, 1, 2].map((column) =>
      [0, 1, 2].reduce((sum, k) => sum + turn[3 * row + k] * turn[3 * column + k] * scale[k] ** 2, 0),
    ),
  );
}

/** Largest errors of positions, of covariances in parts of the largest variance, and of smallest scales. */
function errorsOf({ made, expected }: Awaited<ReturnType<typeof skinOnGpu>>) {
  const errors = { position: 0, covariance: 0, smallest: 0 };
  for (const [i, splat] of expected.entries()) {
    const actual = unpackSplat(made, i);
    const [a, b] = [actual, splat].map(covarianceOf);
    const largest = b[0] + b[4] + b[8];
    for (let axis = 0; axis < 3; axis++)
      errors.position = Math.max(errors.position, Math.abs(actual.position[axis] - splat.position[axis]));
    if (largest > 1e-30)
      for (let k = 0; k < 9; k++)
        errors.covariance = Math.max(errors.covariance, Math.abs(a[k] - b[k]) / largest);
    // Thinner than this, rounding decides, and no pixel shows it.
    const [thin, expectedThin] = [actual, splat].map(({ scale }) => Math.min(...scale));
    if (expectedThin > 1e-4 * Math.sqrt(largest))
      errors.smallest = Math.max(errors.smallest, Math.abs(Math.log(thin / expectedThin)));
  }
  return errors;
}

describe('skin-geometry', () => {
  for (const [precision, most] of [
    ['f32', { position: 5e-6, covariance: 1e-5, smallest: 5e-3 }],
    ['packed', { position: 5e-6, covariance: 1e-3, smallest: 0.01 }],
  ] as const)
    gpuTest(`moves and turns splats as the reference does, ${precision}`, async () => {
      const result = await skinOnGpu(precision);
      const errors = errorsOf(result);
      expect(errors.position).toBeLessThan(most.position);
      expect(errors.covariance).toBeLessThan(most.covariance);
      expect(errors.smallest).toBeLessThan(most.smallest);
      for (let i = 0; i < COUNT; i++) {
        const { opacity, colorDc, rotation, scale } = unpackSplat(result.made, i);
        expect([opacity, ...colorDc]).toEqual([result.expected[i].opacity, ...result.expected[i].colorDc]);
        expect(Math.hypot(...rotation)).toBeCloseTo(1, 4);
        expect(scale.every((value) => value >= 0 && Number.isFinite(value))).toBe(true);
      }
    });

  gpuTest('leaves splats at rest as they are, but for rounding', async () => {
    const skin = new SplatSkin(
      { indices: new Uint8Array(4 * COUNT), weights: new Float32Array(4 * COUNT).fill(1) },
      1,
    );
    const { made } = await skinOnGpu('f32', skin);
    const rest = packGeometry(SET, 'f32');
    for (let i = 0; i < COUNT; i++) {
      const [a, b] = [made, rest].map((geometry) => unpackSplat(geometry, i));
      for (let axis = 0; axis < 3; axis++) {
        expect(Math.abs(a.position[axis] - b.position[axis])).toBeLessThan(1e-6);
        if (b.scale[axis] > 1e-30) expect(Math.abs(a.scale[axis] / b.scale[axis] - 1)).toBeLessThan(1e-5);
      }
    }
  });

  const faults = {
    'covariances that do not turn': ['let turned = linear * rot', 'let turned = rot'],
    'axes that are not made perpendicular': ['sweep < SWEEPS', 'sweep < 0u'],
    'joints in another order': ['8u * k)) & 0xffu', '8u * (3u - k))) & 0xffu'],
    'matrices read by columns': ['transpose(mat3x3f(x.xyz, y.xyz, z.xyz))', 'mat3x3f(x.xyz, y.xyz, z.xyz)'],
  } as const;
  for (const [what, [find, replace]] of Object.entries(faults))
    gpuTest(`${what} are noticed`, async () => {
      const shaders = new Pipelines(gpu.device, { file: 'stages/skin-geometry', find, replace });
      const { position, covariance } = errorsOf(await skinOnGpu('f32', skinOf(), shaders));
      expect(Math.max(position, covariance)).toBeGreaterThan(0.01);
    });
});
