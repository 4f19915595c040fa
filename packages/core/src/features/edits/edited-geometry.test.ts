import { describe, expect, test } from 'vitest';
import { splatsFromArrays } from '../../data/editing/splats-from-arrays.ts';
import { chunksOf, logScalesOf, setLogScales } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, packGeometry } from '../../data/packing/geometry.ts';
import { type LogScaleRange, logScaleRange } from '../../data/packing/log-scale.ts';
import { unpackSplat } from '../../reference/packing.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { editedGeometry, editedLogScales, editedPosition, packEdited } from './edited-geometry.data.ts';
import { SplatEdits } from './splat-edits.data.ts';

const COUNT = 40;
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
const RANGE = logScaleRange(-6, 0);
/** The one chunk of the splats. */
const CHUNKS = chunksWith(RANGE);
/** Rows in another order than that of storage. */
const ROWS = Uint32Array.from({ length: COUNT }, (_, i) => (i * 7) % COUNT);

function chunksWith(range: LogScaleRange): Float32Array<ArrayBuffer> {
  const chunks = chunksOf(BEFORE);
  setLogScales(chunks, 0, range);
  return chunks;
}

/** Geometry with its edits, as a cloud about this origin stores it. */
function edited(
  precision: 'f32' | 'packed',
  edits: SplatEdits,
  origin: [number, number, number] = [0, 0, 0],
) {
  return editedGeometry(packGeometry(BEFORE, precision, CHUNKS), origin, ROWS, edits);
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
    const packed = packEdited(edited(precision, allEdits()), 0, COUNT, precision, CHUNKS);
    const actual = split(packed, precision);
    const expected = split(packGeometry(splatsFromArrays(VALUES), precision, CHUNKS).words, precision);
    if (precision === 'packed') expect(actual.rest).toEqual(expected.rest);
    else for (const [i, value] of expected.rest.entries()) expect(actual.rest[i]).toBeCloseTo(value, 5);
    for (const [i, value] of expected.opacities.entries()) expect(actual.opacities[i]).toBeCloseTo(value, 4);
  });

  test('as packed from f32, to the step', () => {
    const splats = edited('f32', new SplatEdits());
    const actual = packEdited(splats, 3, 20, 'packed', CHUNKS);
    const expected = packGeometry(BEFORE, 'packed', CHUNKS).words.subarray(8 * 3, 8 * 20);
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
    const words = packEdited(edited(precision, edits), 0, COUNT, precision, CHUNKS);
    const before = packGeometry(BEFORE, precision, CHUNKS).words;
    const stride = GEOMETRY_WORDS[precision];
    const changed = [...words.keys()].filter((i) => words[i] !== before[i]);
    expect(changed).toEqual([5 * stride + (precision === 'f32' ? 3 : 4)]);
    expect(split(words, precision).opacities[5]).toBe(0);
    edits.set([ROWS[5]], { visible: true });
    expect(packEdited(edited(precision, edits), 0, COUNT, precision, CHUNKS)).toEqual(before);
  });

  test('about the origin of their cloud', () => {
    const splats = edited('packed', allEdits(), [100, 20, -3]);
    const position = new Float32Array(3);
    editedPosition(splats, 2, position);
    const [x, y, z] = VALUES.positions.subarray(6, 9);
    expect([...position]).toEqual([x - 100, y - 20, z + 3].map(Math.fround));
    expect([...new Float32Array(packEdited(splats, 2, 3, 'packed', CHUNKS).buffer, 0, 3)]).toEqual([
      ...position,
    ]);
  });
});

describe('the range of the log scales of a chunk', () => {
  const withScales = (scale: number) => {
    const edits = new SplatEdits(COUNT);
    edits.set([ROWS[3]], { scales: [scale, 0.1, 0.1] });
    return edits;
  };

  test.each(['packed', 'f32'] as const)(
    'stays while edited splats are within half a step of it, %s',
    (precision) => {
      for (const logScale of [-6, -3, RANGE.step / 3])
        expect(editedLogScales(edited(precision, withScales(Math.exp(logScale))), 0)).toEqual(RANGE);
    },
  );

  test('is wider where edited splats leave it, and as before when they are back', () => {
    const edits = withScales(Math.exp(2));
    const splats = edited('packed', edits);
    expect(editedLogScales(splats, 0)).toEqual(logScaleRange(-6, 2));
    edits.set([ROWS[4]], { scales: [1e-30, 0.1, 0.1] });
    expect(editedLogScales(splats, 0)).toEqual(logScaleRange(-40, 2));
    edits.reset();
    expect(editedLogScales(splats, 0)).toEqual(RANGE);
  });

  test('changes packed splats by half a step of a wider one, and f32 not at all', () => {
    const wider = chunksWith(logScaleRange(-9, 3));
    const splats = edited('packed', new SplatEdits());
    const words = packEdited(splats, 0, COUNT, 'packed', wider);
    for (let i = 0; i < COUNT; i++) {
      const before = unpackSplat(splats.geometry, i).scale;
      const after = unpackSplat({ precision: 'packed', words, chunks: wider }, i).scale;
      for (const axis of [0, 1, 2])
        expect(Math.abs(Math.log(after[axis] / before[axis]))).toBeLessThanOrEqual(
          logScalesOf(wider, 0).step / 2 + 1e-6,
        );
    }
    const f32 = edited('f32', new SplatEdits());
    expect(packEdited(f32, 0, COUNT, 'f32', wider)).toEqual(f32.geometry.words);
  });
});
