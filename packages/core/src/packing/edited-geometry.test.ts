import { describe, expect, test } from 'vitest';
import { splatsFromArrays } from '../editing/splats-from-arrays.ts';
import { SplatEdits } from '../splats/splat-edits.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import {
  editedGeometry,
  editedLogScale,
  editedPosition,
  packEdited,
  withLogScaleRange,
} from './edited-geometry.ts';
import { GEOMETRY_WORDS, logScaleRange, packGeometry } from './geometry.ts';

const COUNT = 40;
const RANGE = logScaleRange(-6, 0);
const random = seededRandom(3);
const column = (width: number, min: number, max: number) =>
  Float32Array.from({ length: width * COUNT }, () => min + (max - min) * random());
const VALUES = {
  positions: column(3, -5, 5),
  scales: column(3, 0.01, 0.9),
  rotations: column(4, -1, 1),
  opacities: column(1, 0, 1),
  colors: column(3, 0, 1),
};
const BEFORE = randomSplats({ count: COUNT, shDegree: 0, logScales: [-5, -1] });
/** Rows in another order than that of storage. */
const ROWS = Uint32Array.from({ length: COUNT }, (_, i) => (i * 7) % COUNT);

/** Geometry with its edits, as a cloud about this origin stores it. */
function edited(
  precision: 'f32' | 'packed',
  edits: SplatEdits,
  origin: [number, number, number] = [0, 0, 0],
) {
  return editedGeometry(packGeometry(BEFORE, precision, RANGE), origin, ROWS, edits);
}

function allEdits(): SplatEdits {
  const edits = new SplatEdits(COUNT);
  edits.set(ROWS, VALUES);
  return edits;
}

/** Words without opacities, which sets hold as logits, and these. */
function split(words: Uint32Array, precision: 'f32' | 'packed') {
  const stride = GEOMETRY_WORDS[precision];
  const floats = new Float32Array(words.buffer);
  const rest: number[] = [];
  const opacities: number[] = [];
  for (const [i, word] of words.entries()) {
    if (precision === 'f32' && i % stride === 3) opacities.push(floats[i]);
    else if (precision === 'packed' && i % stride === 4) {
      opacities.push((word >>> 16) / 65535);
      rest.push(word & 0xffff);
    } else rest.push(precision === 'f32' ? floats[i] : word);
  }
  return { rest, opacities };
}

describe('edited splats are packed', () => {
  test.each(['packed', 'f32'] as const)('as a set with these values is, %s', (precision) => {
    const packed = packEdited(edited(precision, allEdits()), 0, COUNT, precision, RANGE);
    const actual = split(packed, precision);
    const expected = split(packGeometry(splatsFromArrays(VALUES), precision, RANGE).words, precision);
    if (precision === 'packed') expect(actual.rest).toEqual(expected.rest);
    else for (const [i, value] of expected.rest.entries()) expect(actual.rest[i]).toBeCloseTo(value, 5);
    for (const [i, value] of expected.opacities.entries()) expect(actual.opacities[i]).toBeCloseTo(value, 4);
  });

  test('as packed from f32, to the step', () => {
    const splats = edited('f32', new SplatEdits());
    const actual = packEdited(splats, 3, 20, 'packed', RANGE);
    const expected = packGeometry(BEFORE, 'packed', RANGE).words.subarray(8 * 3, 8 * 20);
    for (const [i, word] of expected.entries()) {
      const [low, high] = [
        Math.abs((actual[i] & 0xffff) - (word & 0xffff)),
        (actual[i] >>> 16) - (word >>> 16),
      ];
      expect(Math.max(low, Math.abs(high))).toBeLessThanOrEqual(1);
    }
  });

  test.each(['packed', 'f32'] as const)('with all bits of what was not edited, %s', (precision) => {
    const edits = new SplatEdits();
    edits.set([ROWS[5]], { visible: false });
    const words = packEdited(edited(precision, edits), 0, COUNT, precision, RANGE);
    const before = packGeometry(BEFORE, precision, RANGE).words;
    const stride = GEOMETRY_WORDS[precision];
    const changed = [...words.keys()].filter((i) => words[i] !== before[i]);
    expect(changed).toEqual([5 * stride + (precision === 'f32' ? 3 : 4)]);
    expect(split(words, precision).opacities[5]).toBe(0);
    edits.set([ROWS[5]], { visible: true });
    expect(packEdited(edited(precision, edits), 0, COUNT, precision, RANGE)).toEqual(before);
  });

  test('about the origin of their cloud', () => {
    const splats = edited('packed', allEdits(), [100, 0, -3]);
    const position = new Float32Array(3);
    editedPosition(splats, 2, position);
    const [x, y, z] = VALUES.positions.subarray(6, 9);
    expect([...position]).toEqual([x - 100, y, z + 3].map(Math.fround));
    expect([...new Float32Array(packEdited(splats, 2, 3, 'packed', RANGE).buffer, 0, 3)]).toEqual([
      ...position,
    ]);
  });
});

describe('sizes', () => {
  test.each(['packed', 'f32'] as const)('are the largest of a splat, %s', (precision) => {
    const before = edited(precision, new SplatEdits());
    const largest = (values: Float32Array) => Math.max(...values.subarray(6, 9));
    expect(editedLogScale(before, 2)).toBeCloseTo(largest(BEFORE.logScales), 3);
    expect(editedLogScale(edited(precision, allEdits()), 2)).toBeCloseTo(Math.log(largest(VALUES.scales)), 5);
  });

  test('move to another range within half a step of each', () => {
    const wider = logScaleRange(-9, 3);
    const geometry = withLogScaleRange(packGeometry(BEFORE, 'packed', RANGE), wider);
    const splats = editedGeometry(geometry, [0, 0, 0], ROWS, new SplatEdits());
    const before = edited('packed', new SplatEdits());
    for (let i = 0; i < COUNT; i++) {
      const moved = Math.abs(editedLogScale(splats, i) - editedLogScale(before, i));
      expect(moved).toBeLessThanOrEqual(wider.step / 2 + 1e-9);
    }
    const f32 = packGeometry(BEFORE, 'f32', RANGE);
    expect(withLogScaleRange(f32, wider)).toEqual({ ...f32, logScaleRange: wider });
  });
});
