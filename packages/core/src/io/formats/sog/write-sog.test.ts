import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../../data/errors.ts';
import type { Harmonics } from '../../../data/packing/harmonics.ts';
import { mortonOrder, permuteSplats } from '../../../data/packing/morton-order.ts';
import type { ShDegree, SplatSet } from '../../../data/splats/splat-set.ts';
import { paletteSplats } from '../../../testing/palette-splats.ts';
import { randomSplats, splatsOf } from '../../../testing/random-splats.ts';
import { splatErrors } from '../../../testing/splat-errors.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { write } from './write-sog.ts';

const read = (bytes: Uint8Array) => readSplats(bytes, { name: 'scene.sog', shPrecision: 'f32' });
const again = async (set: SplatSet) => read(await write(set, {}));
/** In the order of the file. */
const ordered = <Kind extends Harmonics>(set: SplatSet<Kind>) =>
  permuteSplats(set, mortonOrder(set.positions, set.count));

/** Three components are off by half a step of √2 / 255, the fourth by up to twice that of all. */
const COMPONENTS_OFF = (Math.sqrt(3) * Math.SQRT1_2) / 255;
const MOST_ANGLE = 2 * Math.hypot(COMPONENTS_OFF, 2 * COMPONENTS_OFF);

test.each<ShDegree>([0, 1, 2, 3])('degree %i comes back within the steps of the format', async (shDegree) => {
  const set = randomSplats({ count: 501, shDegree, halfExtent: 30, logScales: [-9, 3], origin: [7, 0, -20] });
  // A rotation of zeros is the identity.
  set.rotations.fill(0, 0, 4);
  const found = await again(set);
  expect(found).toMatchObject({
    fileFacts: { format: 'sog', variant: '2' },
    harmonics: { degree: shDegree },
  });
  expect(found.isAntialiased).toBeUndefined();
  const errors = splatErrors(found, ordered(set));
  // Half of 65,535 steps of ln(|v| + 1) from −50 to 50, stretched by |v| + 1; and float32.
  expect(errors.position).toBeLessThanOrEqual(((2 * Math.log(51)) / 65_535 / 2) * 51 + 4e-6);
  expect(errors.angle).toBeLessThanOrEqual(MOST_ANGLE);
  expect(errors.opacity).toBeLessThanOrEqual(0.5 / 255 + 1e-7);
  // 256 of 1,503 uniform values: without a bound, but twice the distance of even steps is ample.
  expect(errors.logScale).toBeLessThanOrEqual(12 / 256);
  expect(errors.colorDc).toBeLessThanOrEqual(3 / 256);
  // Each splat has a set of harmonics of its own, whose values are uniform from −0.3 to 0.3.
  expect(errors.firstHarmonics).toBeLessThanOrEqual(0.6 / 256);
  expect(errors.otherHarmonics).toBeLessThanOrEqual(0.6 / 256);
});

/** Splats of degree 1 of which `differing` have harmonics unlike all others', but for one coefficient of 256 values. */
function splatsDiffering(count: number, differing: number) {
  const set = randomSplats({ count, shDegree: 1 });
  set.harmonics.coefficients.forEach((_, i, coefficients) => {
    const splat = Math.floor(i / 9) % differing;
    coefficients[i] = ((splat >> (8 * (i % 9))) & 255) / 256;
  });
  return set;
}

const notesOf = async (set: SplatSet) => {
  const notes: string[] = [];
  await write(set, { onNote: (note) => notes.push(note) });
  return notes;
};

/**
 * @fault Files: more sets of harmonics than a SOG holds, 65,536
 * @consequence splats share sets, and a note says how many do
 */
test('a note says how many splats share sets that are not theirs', async () => {
  const count = 65_600;
  const [note, ...others] = await notesOf(splatsDiffering(count, count));
  expect(note).toMatch(/^(\d+) of 65,\d+ splats share sets of harmonics.*65,536 sets at most/);
  const sharing = Number.parseInt(note, 10);
  // Of two that share, one may be rounded to its own values.
  expect(sharing).toBeGreaterThanOrEqual(count - 65_536);
  expect(sharing).toBeLessThanOrEqual(2 * (count - 65_536));
  expect(others).toEqual([]);
});

test.each([
  [300, 300],
  [255, 255],
  [300, 4],
  [65_600, 65_536],
])('no note if no set is lost: %i splats with %i sets', async (count, differing) => {
  expect(await notesOf(splatsDiffering(count, differing))).toEqual([]);
});

test('harmonics that splats share keep their values, where these are few', async () => {
  const set = randomSplats({ count: 64, shDegree: 2 });
  const { coefficients } = set.harmonics;
  coefficients.forEach((_, i) => {
    coefficients[i] = ((Math.floor(i / 24) % 20) * 7 + (i % 24)) / 256;
  });
  const errors = splatErrors(await again(set), ordered(set));
  expect(errors).toMatchObject({ firstHarmonics: 0, otherHarmonics: 0 });
});

test('splats of a SOG are written as they were', async () => {
  const once = await again(randomSplats({ count: 300, shDegree: 3, opacityLogits: [-9, 9] }));
  const twice = await read(await write(once, {}));
  const errors = splatErrors(twice, ordered(once));
  expect(errors).toMatchObject({ logScale: 0, opacity: 0, colorDc: 0, firstHarmonics: 0, otherHarmonics: 0 });
  // The range is found in float32.
  expect(errors.position).toBeLessThan(1e-6);
  // The component that is left out comes from the others, and may no longer be the largest.
  expect(errors.angle).toBeLessThanOrEqual(MOST_ANGLE);
});

test('a palette is written as it is', async () => {
  const set = paletteSplats({ count: 300, shDegree: 3, entryCount: 70 });
  // As few values as a codebook has, and exact in its bytes.
  set.harmonics.entries.forEach((_, i, entries) => {
    entries[i] = ((i * 7) % 256) / 256;
  });
  const found = await readSplats(await write(set, {}), { shPrecision: 'palette' });
  const { indices } = permuteSplats(set, mortonOrder(set.positions, set.count)).harmonics;
  expect(found.harmonics).toEqual({ ...set.harmonics, indices });
});

describe('few splats', () => {
  test.each([1, 2, 3, 5, 16, 17])('%i', async (count) => {
    const set = randomSplats({ count, shDegree: 1 });
    const errors = splatErrors(await again(set), ordered(set));
    expect(errors.position).toBeLessThan(2e-5);
    expect(errors.angle).toBeLessThanOrEqual(MOST_ANGLE);
    expect(errors).toMatchObject({ logScale: 0, colorDc: 0 });
  });

  test('all alike, at one place', async () => {
    const set = splatsOf(new Array(50).fill({ position: [1, -2, 300], colorDc: [0.5, 0.25, -1] }));
    const found = await again(set);
    expect(found.opacityLogits).toEqual(set.opacityLogits);
    const { position, angle, ...others } = splatErrors(found, set);
    expect(others).toMatchObject({ logScale: 0, opacity: 0, colorDc: 0 });
    // Of float32, after a logarithm and a power.
    expect(position).toBeLessThan(300 * 2 ** -22);
    expect(angle).toBeLessThanOrEqual(MOST_ANGLE);
  });

  test('opacities of 0 and 1', async () => {
    const logits = [Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY];
    const set = splatsOf(logits.map((opacityLogit) => ({ opacityLogit })));
    expect([...(await again(set)).opacityLogits]).toEqual(logits);
  });
});

test.each([true, false, undefined])('antialiased: %s', async (isAntialiased) => {
  const set = { ...randomSplats({ count: 1 }), isAntialiased };
  expect((await again(set)).isAntialiased).toBe(isAntialiased);
});

test('the same bytes each time', async () => {
  const set = randomSplats({ count: 400, shDegree: 1 });
  expect(Buffer.compare(await write(set, {}), await write(set, {}))).toBe(0);
});

test.each<[string, (set: SplatSet) => unknown]>([
  ['position', ({ positions }) => positions.fill(Number.NaN, 4, 5)],
  ['scale', ({ logScales }) => logScales.fill(Number.POSITIVE_INFINITY, 4, 5)],
  ['rotation', ({ rotations }) => rotations.fill(Number.NaN, 4, 5)],
  ['colour', ({ colorDc }) => colorDc.fill(Number.NEGATIVE_INFINITY, 5, 6)],
])('a %s that is not finite is refused, with the splat', async (what, spoil) => {
  const set = randomSplats({ count: 3 });
  spoil(set);
  await expect(write(set, {})).rejects.toThrow(new RegExp(`^Splat 1 has a ${what} that is not finite`));
  await expect(write(set, {})).rejects.toThrow(InvalidArgumentError);
});
