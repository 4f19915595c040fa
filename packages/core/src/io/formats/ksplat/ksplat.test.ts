import { describe, expect, test } from 'vitest';
import { fromHalfBits, toHalfBits } from '../../../data/layout/half.ts';
import { readCoefficients } from '../../../data/packing/harmonics.ts';
import { coefficientsPerSplat } from '../../../data/splats/splat-set.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import {
  BLOCK,
  type KsplatLevel,
  type KsplatSection,
  ksplatBytes,
  randomSections,
  SH_GREATEST,
  SH_LEAST,
  STEPS,
} from '../../../testing/ksplat-fixture.ts';
import { chunked } from '../../../testing/ply-fixture.ts';
import { outcomeOf } from '../../../testing/read-damaged.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { detectFormat } from '../detect.ts';

const SH_C0 = 0.28209479177387814;

const splatsOf = (sections: readonly KsplatSection[]) =>
  sections.flatMap(({ buckets }) => buckets.flatMap(({ splats }) => splats));
const read = (bytes: Uint8Array) => readSplats(bytes, { name: 'scene.ksplat', shPrecision: 'f32' });

describe('reads', () => {
  for (const level of [0, 1, 2] as const) {
    test.each([0, 1, 2] as const)(`level ${level}, SH degree %i`, async (degree) => {
      const sections = randomSections(12, [degree, degree]);
      const splats = splatsOf(sections);
      const set = await read(ksplatBytes(sections, level));
      const fileFacts = { format: 'ksplat', variant: `0.1, level ${level}` };
      expect(set).toMatchObject({ count: splats.length, dropped: {}, harmonics: { degree }, fileFacts });
      const half = (value: number) => (level === 0 ? value : fromHalfBits(toHalfBits(value)));
      const sh = new Float64Array(coefficientsPerSplat(degree));
      // Half a step of 16 bits; float32 about centres and origins of up to 25 adds less than 4e-6.
      const positionBound = level === 0 ? 4e-6 : BLOCK / 2 / STEPS / 2 + 4e-6;
      // Writers of level 2 round down, and readers take the lower end.
      const shBound = level === 2 ? (SH_GREATEST - SH_LEAST) / 255 + 1e-6 : 0;
      for (const [i, splat] of splats.entries()) {
        for (let axis = 0; axis < 3; axis++) {
          const position = set.positions[3 * i + axis] + set.origin[axis];
          expect(Math.abs(position - splat.position[axis])).toBeLessThanOrEqual(positionBound);
          expect(set.logScales[3 * i + axis]).toBe(Math.fround(Math.log(half(splat.scale[axis]))));
          expect(set.colorDc[3 * i + axis]).toBe(Math.fround((splat.rgba[axis] / 255 - 0.5) / SH_C0));
        }
        expect([...set.rotations.subarray(4 * i, 4 * i + 4)]).toEqual(splat.rotation.map(half));
        const alpha = splat.rgba[3] / 255;
        expect(set.opacityLogits[i]).toBe(Math.fround(Math.log(alpha / (1 - alpha))));
        readCoefficients(set.harmonics, i, sh);
        for (const [k, value] of splat.sh.entries())
          expect(Math.abs(sh[k] - (level === 1 ? half(value) : value))).toBeLessThanOrEqual(shBound);
      }
    });
  }

  test('sections of different degrees: missing coefficients are 0', async () => {
    const sections = randomSections(8, [0, 2, 1]);
    const set = await read(ksplatBytes(sections, 1));
    expect(set.harmonics.degree).toBe(2);
    const sh = new Float64Array(24);
    for (const [i, splat] of splatsOf(sections).entries()) {
      readCoefficients(set.harmonics, i, sh);
      const expected = [...splat.sh.map((value) => fromHalfBits(toHalfBits(value))), ...Array(24).fill(0)];
      expect([...sh]).toEqual(expected.slice(0, 24));
    }
  });

  test('ranges that the header leaves at 0', async () => {
    const bytes = ksplatBytes(randomSections(4, [1]), 2);
    const view = new DataView(bytes.buffer);
    const expected = await read(bytes);
    view.setUint32(4096 + 24, 0, true);
    view.setFloat32(36, 0, true);
    view.setFloat32(40, 0, true);
    const set = await read(bytes);
    expect(set.positions).toEqual(expected.positions);
    const [sh, before] = [set, expected].map(({ harmonics }) => {
      const values = new Float64Array(9);
      readCoefficients(harmonics, 0, values);
      return values;
    });
    for (const [k, value] of sh.entries()) {
      const fraction = (before[k] - SH_LEAST) / (SH_GREATEST - SH_LEAST);
      expect(value).toBeCloseTo(3 * fraction - 1.5, 5);
    }
  });

  test('a scale that is 0 in halves is flat; negative ones are dropped', async () => {
    const [section] = randomSections(4, [0]);
    const first = section.buckets[0].splats[0];
    const buckets = section.buckets.with(0, {
      ...section.buckets[0],
      splats: [{ ...first, scale: [1, 1e-9, 0.5] }],
    });
    const bytes = ksplatBytes([{ ...section, buckets }], 1);
    const set = await read(bytes);
    expect([...set.logScales.subarray(0, 3)]).toEqual([0, -20, Math.fround(Math.log(0.5))]);
    const negative = buckets.with(0, { ...buckets[0], splats: [{ ...first, scale: [1, -1, 1] }] });
    expect((await read(ksplatBytes([{ ...section, buckets: negative }], 1))).dropped).toEqual({
      'non-finite-scale': 1,
    });
  });

  test('it is told by its bytes, whatever its name; streams of unknown size', async () => {
    const bytes = ksplatBytes(randomSections(5, [1]), 1);
    expect(detectFormat(bytes.subarray(0, 512), 'a', ['a.bin']).name).toBe('ksplat');
    const expected = await read(bytes);
    expect(await readSplats(chunked(bytes, [100, 3000]), { shPrecision: 'f32' })).toEqual(expected);
  });
});

describe('refuses', () => {
  const sections = randomSections(8, [1, 1]);
  const changed = (level: KsplatLevel, change: (view: DataView) => void) => {
    const bytes = ksplatBytes(sections, level);
    change(new DataView(bytes.buffer));
    return bytes;
  };
  const word = (offset: number, value: number) => (view: DataView) => view.setUint32(offset, value, true);
  const short = (offset: number, value: number) => (view: DataView) => view.setUint16(offset, value, true);
  test.each([
    ['version 1', changed(0, (view) => view.setUint8(0, 1)), 'bad-header', /version 1\.1; versions 0\.1/],
    ['version 0.0', changed(0, (view) => view.setUint8(1, 0)), 'bad-header', /version 0\.0/],
    ['level 3', changed(1, short(20, 3)), 'bad-header', /level 3 is not one of 0, 1, 2/],
    ['degree 3', changed(1, short(4096 + 40, 3)), 'bad-header', /section 0 has harmonics of degree 3/],
    ['no splats', changed(1, word(16, 0)), 'empty', /0 splats/],
    ['more splats', changed(1, word(16, 100)), 'damaged', /promises 100 splats, its sections 26/],
    ['no sections', changed(1, word(4, 0)), 'damaged', /its sections 0/],
    [
      'a section with more splats than room',
      changed(1, word(4096 + 4, 1)),
      'damaged',
      /section 0 has 13 splats, but room for 1/,
    ],
    ['too few buckets', changed(1, word(4096 + 12, 1)), 'damaged', /buckets among 1 of 12/],
    ['buckets of another size', changed(2, short(5120 + 20, 16)), 'damaged', /section 1 has .* of 16 bytes/],
    [
      'buckets that hold less',
      changed(1, word(4096 + 2048 + 8, 2)),
      'damaged',
      /the buckets of 13 splats hold only/,
    ],
    [
      '4 billion sections',
      changed(1, word(4, 2 ** 32 - 1)),
      'truncated',
      /headers of its 4294967295 sections/,
    ],
    ['4 billion buckets', changed(1, word(4096 + 12, 2 ** 32 - 1)), 'truncated', /its 26 splats take/],
    ['4 billion splats', changed(1, word(16, 2 ** 32 - 1)), 'too-large', /more than maxSplats/],
  ] as const)('%s', async (_, bytes, code, says) => {
    const before = process.memoryUsage().arrayBuffers;
    for (const source of [bytes, chunked(bytes, [5000])]) {
      const error = await fileErrorOf(readSplats(source, { name: 'scene.ksplat' }));
      expect(error.message).toMatch(says);
      expect(error.code).toBe(code);
    }
    expect(process.memoryUsage().arrayBuffers - before).toBeLessThan(64e6);
  });

  test('a web page with that name', async () => {
    expect((await fileErrorOf(read(Buffer.from('<!doctype html>'.padEnd(5000))))).message).toMatch(
      /web page/,
    );
  });

  test('every truncation', async () => {
    const bytes = ksplatBytes(randomSections(2, [1]), 2);
    const ends = 4096 + 1024;
    const lengths = Array.from({ length: bytes.length }, (_, i) => i);
    for (const length of lengths.filter((each) => each > ends - 20 || each % 100 === 0)) {
      const outcome = await outcomeOf(bytes.slice(0, length), 'a.ksplat', length % 2 ? 300 : undefined);
      expect(outcome).toMatchObject({ code: length === 0 ? 'empty' : 'truncated' });
    }
  });
});
