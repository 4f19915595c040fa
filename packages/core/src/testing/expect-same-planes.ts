import { expect } from 'vitest';
import { CHUNK_WORDS } from '../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { logScalesOf } from '../data/packing/chunks.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../data/packing/geometry.ts';
import { type PackedHarmonics, readCoefficients } from '../data/packing/harmonics.ts';
import { coefficientsPerSplat } from '../data/splats/splat-set.ts';
import { unpackSplat } from '../reference/packing.ts';

/**
 * Part of the steps that may differ by one, where float32 and float64 fall to different sides of
 * half a step.
 */
const DIFFERING_PART = 0.03;
/** Values of fewer splats may all happen to be halfway between steps. */
const MANY_SPLATS = 100;
/** Units in the last place by which float32 values may differ. */
const MAX_ULPS = 8;

/**
 * Expects the same geometry. Positions and half floats are the same bits. Other packed values
 * differ by one step at most (log scales by `logScaleError` besides), and few of them do; float32
 * values by a few units in the last place. Of two components of a rotation that are as large,
 * either may be the one left out.
 */
export function expectSameGeometry(actual: PackedGeometry, expected: PackedGeometry): void {
  expect(actual.words.length).toBe(expected.words.length);
  if (expected.precision === 'f32') expectSameFloats(actual.words, expected.words);
  else expectSamePacked(actual, expected);
}

function expectSamePacked(actual: PackedGeometry, expected: PackedGeometry): void {
  const width = GEOMETRY_WORDS.packed;
  const count = expected.words.length / width;
  const error = logScaleError(expected.chunks);
  let differing = 0;
  for (let i = 0; i < count; i++) {
    const [a, b] = [actual, expected].map(({ words }) => words.subarray(i * width, (i + 1) * width));
    const place = `splat ${i}`;
    // An `expect` for each word would take longer than making the planes.
    for (const word of [0, 1, 2, 3])
      if (a[word] !== b[word]) expect.fail(`${place}, word ${word}: ${a[word]} for ${b[word]}`);
    const expectSteps = (x: number, y: number, most: number, what: string) => {
      if (x !== y) differing++;
      if (!(Math.abs(x - y) <= most)) expect.fail(`${place}, ${what}: ${x} for ${y}`);
    };
    expectSteps(a[4] & 0xffff, b[4] & 0xffff, 0, 'half float');
    expectSteps(a[4] >>> 16, b[4] >>> 16, 1, 'opacity');
    const { step } = logScalesOf(expected.chunks, Math.floor(i / CHUNK_SPLATS));
    const [sizes, expectedSizes] = [actual, expected].map((geometry) => unpackSplat(geometry, i).scale);
    for (const axis of [0, 1, 2]) {
      const away = Math.abs(Math.log(sizes[axis] / expectedSizes[axis]));
      if (away > step / 2 + error) differing++;
      if (!(away <= 1.01 * step + error)) expect.fail(`${place}, log scale: ${away} beside`);
    }
    const [left, right] = [a, b].map(leftOut);
    if (left === right) {
      expectSteps((a[6] >>> 16) & 0x7fff, (b[6] >>> 16) & 0x7fff, 1, 'rotation');
      expectSteps(a[7] & 0x7fff, b[7] & 0x7fff, 1, 'rotation');
      expectSteps(a[7] >>> 16, b[7] >>> 16, 1, 'rotation');
    } else {
      const [q, r] = [actual, expected].map((geometry) => unpackSplat(geometry, i).rotation);
      const cosine = q.reduce((sum: number, value: number, k: number) => sum + value * r[k], 0);
      expect(Math.abs(cosine), `${place}, rotation`).toBeGreaterThan(1 - 1e-7);
    }
  }
  if (count >= MANY_SPLATS) expect(differing).toBeLessThanOrEqual(DIFFERING_PART * 7 * count);
}

/** Index of the component of the rotation that is left out. */
function leftOut(words: Uint32Array): number {
  return ((words[6] >>> 31) & 1) | (((words[7] >>> 15) & 1) << 1);
}

function expectSameFloats(actual: Uint32Array, expected: Uint32Array): void {
  for (let i = 0; i < expected.length; i++) {
    if (actual[i] === expected[i]) continue;
    // Below the smallest normal number, devices may flush to zero.
    if ((expected[i] & 0x7fffffff) < 0x800000 && (actual[i] & 0x7fffffff) <= 0x800000) continue;
    if (!(Math.abs(actual[i] - expected[i]) <= MAX_ULPS))
      expect.fail(`word ${i}: ${actual[i].toString(16)} for ${expected[i].toString(16)}`);
  }
}

/** Expects the same harmonics: equal bits, but for bytes, few of which may differ by one step. */
export function expectSameHarmonics(actual: PackedHarmonics, expected: PackedHarmonics, count: number): void {
  if (expected.precision !== 'u8') {
    expect(actual.words).toEqual(expected.words);
    return;
  }
  const width = coefficientsPerSplat(expected.degree);
  const [a, b] = [new Float64Array(width), new Float64Array(width)];
  let differing = 0;
  for (let i = 0; i < count && width > 0; i++) {
    const at = i * expected.wordsPerSplat;
    const [scale, expectedScale] = [actual, expected].map(({ words }) => words[at] & 0xffff);
    if (scale !== expectedScale) expect.fail(`scale of splat ${i}: ${scale} for ${expectedScale}`);
    readCoefficients(actual, i, a);
    readCoefficients(expected, i, b);
    const step = Math.max(...b.map(Math.abs)) / 127;
    for (let k = 0; k < width; k++) {
      if (a[k] === b[k]) continue;
      differing++;
      if (!(Math.abs(a[k] - b[k]) <= 1.01 * step))
        expect.fail(`splat ${i}, value ${k}: ${a[k]} for ${b[k]}, steps of ${step}`);
    }
  }
  if (count >= MANY_SPLATS) expect(differing).toBeLessThanOrEqual((count * width) / 1000);
}

/** Error bound of the GPU's log scales, which are float32 before packing, by the range of `chunks`. */
function logScaleError(chunks: Float32Array): number {
  const ranges = Array.from({ length: chunks.length / CHUNK_WORDS.count }, (_, i) => logScalesOf(chunks, i));
  const smallest = Math.min(...ranges.map(({ min }) => min));
  const largest = Math.max(...ranges.map(({ min, step }) => min + 65535 * step));
  return 3e-6 + 4e-7 * (largest - smallest);
}

/** Expects the same chunks: equal bounds (−0 is 0), ranges of log scales to `logScaleError`. */
export function expectSameChunks(actual: Float32Array, expected: Float32Array): void {
  expect(actual.length).toBe(expected.length);
  const { minLogScale, logScaleStep, count } = CHUNK_WORDS;
  const error = logScaleError(expected);
  const errors: Record<number, number> = { [minLogScale]: error, [logScaleStep]: (2 * error) / 65535 };
  for (const [i, value] of expected.entries()) {
    const away = Math.abs(actual[i] - value);
    if (away <= (errors[i % count] ?? 0)) continue;
    expect.fail(`chunk ${Math.floor(i / count)}, word ${i % count}: ${actual[i]} for ${value}`);
  }
}
