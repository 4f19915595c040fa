import { readFileSync } from 'node:fs';
import { describe, expect, test } from 'vitest';
import { transformSplats } from '../../data/editing/transform-splats.ts';
import { type Harmonics, readCoefficients } from '../../data/packing/harmonics.ts';
import { normalizedRotation } from '../../data/packing/rotation.ts';
import { ROW_SLOT } from '../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type SplatSet } from '../../data/splats/splat-set.ts';
import { rotationMatrix } from '../../reference/covariance.ts';
import { fixtureSplats } from '../../testing/fixtures/fixture-splats.ts';
import { readSplats } from '../loading/read-splats.ts';
import { encodePly } from './ply/write-ply.ts';

const SH_C0 = 0.28209479177387814;

type Splats = SplatSet<Harmonics>;

const readFixture = (name: string) =>
  readSplats(readFileSync(new URL(`../../testing/fixtures/${name}`, import.meta.url)), {
    shPrecision: 'f32',
    name,
  });

/** By `ROW_SLOT`, but a unit quaternion, and the opacity from 0 to 1. */
function rowOf({ harmonics, ...set }: Splats, i: number): Float64Array {
  const row = new Float64Array(ROW_SLOT.harmonics + coefficientsPerSplat(harmonics.degree));
  for (let k = 0; k < 3; k++) {
    row[ROW_SLOT.position + k] = set.positions[3 * i + k] + set.origin[k];
    row[ROW_SLOT.logScale + k] = set.logScales[3 * i + k];
    row[ROW_SLOT.colorDc + k] = set.colorDc[3 * i + k];
  }
  normalizedRotation(set.rotations, 4 * i, row.subarray(ROW_SLOT.rotation, ROW_SLOT.rotation + 4));
  row[ROW_SLOT.opacity] = 1 / (1 + Math.exp(-set.opacityLogits[i]));
  readCoefficients(harmonics, i, row.subarray(ROW_SLOT.harmonics));
  return row;
}

/** Errors of each property's values; of position, log scale and colour by axis or channel. */
type Errors = Record<keyof typeof ROW_SLOT, Float64Array>;

/**
 * Compares each splat with the nearest of `truth`, since writers sort splats; harmonics that
 * `found` lacks are not compared. Also returns the largest angle between rotations, in radians.
 */
function errorsOf(found: Splats, truth: Splats): { worst: Errors; mean: Errors; angle: number } {
  const trueRows = Array.from({ length: truth.count }, (_, i) => rowOf(truth, i));
  const length = ROW_SLOT.harmonics + coefficientsPerSplat(found.harmonics.degree);
  const [worst, mean] = [new Float64Array(length), new Float64Array(length)];
  let angle = 0;
  const nearest = new Set<number>();
  for (let i = 0; i < found.count; i++) {
    const row = rowOf(found, i);
    const at = nearestOf(row, trueRows);
    nearest.add(at);
    const expected = trueRows[at];
    const rotation = row.subarray(ROW_SLOT.rotation, ROW_SLOT.rotation + 4);
    const product = rotation.reduce((sum, part, k) => sum + part * expected[ROW_SLOT.rotation + k], 0);
    if (product < 0) for (let k = 0; k < 4; k++) rotation[k] *= -1;
    const away = rotation.map((part, k) => part - expected[ROW_SLOT.rotation + k]);
    angle = Math.max(angle, 4 * Math.asin(Math.hypot(...away) / 2));
    for (let slot = 0; slot < length; slot++) {
      const error = Math.abs(row[slot] - expected[slot]);
      worst[slot] = Math.max(worst[slot], error);
      mean[slot] += error / found.count;
    }
  }
  expect(nearest.size).toBe(truth.count);
  expect(found).toMatchObject({ count: truth.count, origin: [0, 0, 0], dropped: {} });
  return { worst: byProperty(worst), mean: byProperty(mean), angle };
}

/** Index of the row whose position is nearest to that of `row`. */
function nearestOf(row: Float64Array, rows: readonly Float64Array[]): number {
  const distances = rows.map((each) => Math.hypot(each[0] - row[0], each[1] - row[1], each[2] - row[2]));
  return distances.indexOf(Math.min(...distances));
}

function byProperty(row: Float64Array): Errors {
  const starts = [...Object.values(ROW_SLOT), row.length];
  const properties = Object.entries(ROW_SLOT).map(([name, start], i) => [
    name,
    row.subarray(start, starts[i + 1]),
  ]);
  return Object.fromEntries(properties);
}

/** Greatest less least value of a column, by axis or channel. */
function extents(column: Float32Array): number[] {
  return [0, 1, 2].map((axis) => {
    const values = column.filter((_, i) => i % 3 === axis);
    return Math.max(...values) - Math.min(...values);
  });
}

function expectWithin(errors: Float64Array, bounds: readonly number[] | number): void {
  for (const [i, error] of errors.entries())
    expect(error, `value ${i}`).toBeLessThanOrEqual(typeof bounds === 'number' ? bounds : bounds[i]);
}

/** With the colours that bytes can hold. */
const clamped = (truth: Splats): Splats => ({
  ...truth,
  colorDc: truth.colorDc.map((value) => Math.max(-0.5 / SH_C0, Math.min(0.5 / SH_C0, value))),
});

describe.each([2, 3] as const)(
  'a file of degree %i that splat-transform wrote from a PLY of ours',
  (degree) => {
    const truth = fixtureSplats(degree);

    test('as PLY holds the same bits in the same order', async () => {
      const set = await readFixture(`degree-${degree}.ply`);
      expect(set.fileFacts?.format).toBe('ply');
      expect(Buffer.from(encodePly(set)).equals(encodePly(truth))).toBe(true);
    });

    test('as compressed PLY holds the same splats within half a step of its chunks', async () => {
      const set = await readFixture(`degree-${degree}.compressed.ply`);
      expect(set).toMatchObject({
        harmonics: { degree },
        fileFacts: { format: 'compressed-ply', writer: 'splat-transform 3.7.0' },
      });
      const { worst } = errorsOf(set, truth);
      // No chunk's bounds are wider than those of all splats.
      const halfSteps = (column: Float32Array, levels: readonly number[]) =>
        extents(column).map((extent, axis) => extent / levels[axis] / 2 + 1e-5);
      expectWithin(worst.position, halfSteps(truth.positions, [2047, 1023, 2047]));
      expectWithin(worst.logScale, halfSteps(truth.logScales, [2047, 1023, 2047]));
      expectWithin(worst.colorDc, halfSteps(truth.colorDc, [255, 255, 255]));
      expectWithin(worst.opacity, 1 / 255 / 2 + 1e-6);
      // The largest part follows from three that are off by half a step of √2 / 1023.
      expectWithin(worst.rotation, (3 * Math.SQRT2) / 1023 / 2);
      expectWithin(worst.harmonics, 8 / 256 / 2 + 1e-6);
    });

    test('as SOG holds the same splats within the steps of its bytes', async () => {
      const set = await readFixture(`degree-${degree}.sog`);
      expect(set).toMatchObject({ harmonics: { degree }, fileFacts: { format: 'sog', variant: '2' } });
      expect(set.isAntialiased).toBeUndefined();
      const { worst, mean } = errorsOf(set, truth);
      // Rounded down to steps of (max − min) / 65535 of ln(|v| + 1), stretched by |v| + 1.
      const logs = truth.positions.map((value) => Math.sign(value) * Math.log1p(Math.abs(value)));
      const stretch = 1 + Math.max(...truth.positions.map(Math.abs));
      expectWithin(
        worst.position,
        extents(logs).map((extent) => (extent / 65535) * stretch),
      );
      // The nearest of 256 values; if these are even, half a step of the extent / 255.
      const halfSteps = (column: Float32Array) => extents(column).map((extent) => extent / 255 / 2);
      expectWithin(mean.logScale, halfSteps(truth.logScales));
      expectWithin(mean.colorDc, halfSteps(truth.colorDc));
      // Rounded down to a step of √2 / 255; the largest component follows from three such errors.
      expectWithin(worst.rotation, (3 * Math.SQRT2) / 255);
      // Rounded down.
      expectWithin(worst.opacity, 1.001 / 255);
      // Found by clustering, for which there is no bound; a wrong order would be far off.
      expectWithin(mean.harmonics, 0.006);
    });

    test('as SPZ holds the same splats, in the same order, within half a step each', async () => {
      const set = await readFixture(`degree-${degree}.spz`);
      expect(set).toMatchObject({ harmonics: { degree }, fileFacts: { format: 'spz', variant: '4' } });
      const { worst, angle } = errorsOf(set, truth);
      expect(set.positions.findIndex((value, i) => Math.abs(value - truth.positions[i]) > 2 ** -13)).toBe(-1);
      // Positions are multiples of 2^-12, log scales of 1/16, opacities of 1/255.
      expectWithin(worst.position, 2 ** -13);
      expectWithin(worst.logScale, 1 / 32);
      expectWithin(worst.opacity, 0.5 / 255 + 1e-7);
      // The colour of degree 0 times 0.15 is a multiple of 1/255.
      expectWithin(worst.colorDc, 0.5 / 255 / 0.15 + 1e-6);
      // Three components of steps of sqrt(1/2)/511 are off by half a step; the fourth one, at least
      // 1/2, by up to twice as much as they are together. The angle is twice the length of all
      // that.
      const off = (Math.sqrt(3) * Math.SQRT1_2) / 511 / 2;
      expect(angle).toBeLessThanOrEqual(2 * Math.hypot(off, 2 * off));
      // Its writer keeps 5 bits of degree 1 and 4 of the others, of bytes for -1 to 1, 255 being 1.
      expectWithin(worst.harmonics.subarray(0, 9), 4.5 / 128);
      expectWithin(worst.harmonics.subarray(9), 8.5 / 128);
    });

    test('as GLB holds the same splats, turned y up, but for rounding', async () => {
      const set = await readFixture(`degree-${degree}.glb`);
      const fileFacts = { format: 'gltf', variant: 'glb', writer: 'splat-transform 3.7.0' };
      expect(set).toMatchObject({ harmonics: { degree }, fileFacts });
      const { worst } = errorsOf(set, transformSplats(truth, { rotation: [0, 0, 0, 1] }));
      for (const errors of Object.values(worst)) expectWithin(errors, 2e-6);
    });
  },
);

test('a .splat that gsplat.js wrote from a PLY of ours holds the same splats in the same order', async () => {
  const truth = clamped(fixtureSplats(2));
  const set = await readFixture('degree-2.splat');
  expect(set.fileFacts?.format).toBe('splat');
  expect(set.positions).toEqual(truth.positions);
  const { worst } = errorsOf(set, truth);
  expectWithin(worst.logScale, 1e-6);
  // Half a step of a byte.
  expectWithin(worst.colorDc, (0.5 / 255 + 1e-6) / SH_C0);
  expectWithin(worst.opacity, 0.5 / 255 + 1e-6);
  // Four parts half a step off, and one step at 0, turn a rotation that is then normalized.
  expectWithin(worst.rotation, 2 / 128);
});

test('a .ksplat that GaussianSplats3D wrote from a PLY of ours holds the same splats', async () => {
  const truth = clamped(fixtureSplats(2));
  const set = await readFixture('degree-2.ksplat');
  const fileFacts = { format: 'ksplat', variant: '0.1, level 1' };
  expect(set).toMatchObject({ harmonics: { degree: 2 }, fileFacts });
  const { worst } = errorsOf(set, truth);
  // Half a step of 16 bits in blocks 5 across.
  expectWithin(worst.position, 5 / 2 / 32767 / 2 + 1e-6);
  // Its writer cuts off the fractions that halves and bytes cannot hold: up to one step of them.
  expectWithin(worst.logScale, 2 ** -10);
  expectWithin(worst.colorDc, (1 / 255 + 1e-6) / SH_C0);
  expectWithin(worst.opacity, 1 / 255 + 1e-6);
  // Four parts that are up to 2^-11 off, together.
  expectWithin(worst.rotation, 2 ** -10);
  // Those from 1/4 to 1/2 are multiples of 2^-12.
  expectWithin(worst.harmonics, 2 ** -12);
});

describe.each([2, 3] as const)('a .rad of degree %i that Spark made of a PLY of ours', (degree) => {
  test('holds the same splats as its leaves, within the steps of its bytes', async () => {
    const bytes = readFileSync(new URL(`../../testing/fixtures/degree-${degree}-lod.rad`, import.meta.url));
    const header = bytes.subarray(0, 1000).toString('latin1');
    const of = (name: string) => Number(new RegExp(`"${name}": (.*),`).exec(header)![1]);
    const [rgbMin, rgbMax] = [of('rgbMin'), of('rgbMax')];
    const clamp = (value: number, min: number, max: number) => Math.max(min, Math.min(max, value));
    // Its writer cuts off a hundredth of all colours at either end.
    const plain = fixtureSplats(degree);
    const colorDc = plain.colorDc.map((dc) => (clamp(dc * SH_C0 + 0.5, rgbMin, rgbMax) - 0.5) / SH_C0);
    const set = await readFixture(`degree-${degree}-lod.rad`);
    expect(set).toMatchObject({ harmonics: { degree }, fileFacts: { format: 'rad' } });
    expect(of('count')).toBeGreaterThan(set.count);
    const { worst, mean, angle } = errorsOf(set, { ...plain, colorDc });
    expectWithin(worst.position, 0);
    // Steps of 21/254 of log scales, and of 1/255 of the range of colours, which were halves before.
    expectWithin(worst.logScale, 21 / 254 / 2 + 2 ** -9);
    expectWithin(worst.colorDc, ((rgbMax - rgbMin) / 255 / 2 + 2 ** -11) / SH_C0);
    // Bytes from 0 to 2 in one of them, halves in the other.
    expectWithin(worst.opacity, 1 / 255 + 2 ** -12);
    // An axis of two bytes and an angle of one.
    expect(angle).toBeLessThanOrEqual(2 * (Math.sqrt(18) / 255 + Math.PI / 255 / 4));
    // Bytes from -1 to 1; or of clusters, for which there is no bound.
    if (degree === 2) expectWithin(worst.harmonics, 0.5 / 127 + 2 ** -10);
    else expectWithin(mean.harmonics, 0.05);
  });
});

/** Largest angle between the axes of two splats' ellipsoids, radians; an axis has no direction. */
function axesApart(first: Float64Array, second: Float64Array): number {
  const [a, b] = [first, second].map((row) => {
    const [w, x, y, z] = row.subarray(ROW_SLOT.rotation, ROW_SLOT.rotation + 4);
    return rotationMatrix(w, x, y, z);
  });
  const cosine = (axis: number) =>
    Math.abs([0, 3, 6].reduce((sum, row) => sum + a[row + axis] * b[row + axis], 0));
  return Math.max(...[0, 1, 2].map((axis) => Math.acos(Math.min(1, cosine(axis)))));
}

/**
 * @fault Files: a format of this project changes in its writer and its reader at once
 * @consequence files that were written before are still read
 */
describe('a file that an earlier version wrote of the splats of degree 3 holds them', () => {
  const truth = fixtureSplats(3);

  test('as bricks', async () => {
    const set = await readFixture('degree-3.bricks');
    expect(set).toMatchObject({ harmonics: { degree: 3 }, fileFacts: { format: 'bricks' } });
    const { worst } = errorsOf(set, truth);
    // Half a step of a cell that is at most 2 across, of log scales, of two steps of colours, and of bytes.
    expectWithin(worst.position, 2 / 16383 / 2 + 1e-6);
    expectWithin(worst.logScale, 1 / 48 + 1e-5);
    expectWithin(worst.colorDc, 1 / 80 + 1e-5);
    expectWithin(worst.opacity, 0.5 / 255 + 1e-6);
    // Half a step of 1/72 on each of a degree's axes, which are turned.
    expectWithin(worst.harmonics, Math.sqrt(7) / 144);
    const trueRows = Array.from({ length: truth.count }, (_, i) => rowOf(truth, i));
    for (let i = 0; i < set.count; i++) {
      const row = rowOf(set, i);
      expect(axesApart(row, trueRows[nearestOf(row, trueRows)]), `splat ${i}`).toBeLessThan(0.02);
    }
  });

  test('as the first of two frames, in the order of storage', async () => {
    const set = await readFixture('degree-3.frames');
    expect(set).toMatchObject({ harmonics: { degree: 3 }, fileFacts: { format: 'frames' } });
    const { worst } = errorsOf(set, truth);
    // Half a step of each.
    expectWithin(worst.position, 2.5e-4);
    expectWithin(worst.logScale, 1 / 128 + 1e-5);
    expectWithin(worst.colorDc, 1 / 256 + 1e-5);
    expectWithin(worst.opacity, 0.5 / 1023 + 1e-6);
    expectWithin(worst.rotation, 1e-3);
    expectWithin(worst.harmonics, 1 / 256 + 1e-6);
  });
});
