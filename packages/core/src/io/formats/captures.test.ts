import { readFileSync } from 'node:fs';
import { capturePath, captures } from '@websplatter/node/captures';
import { describe, expect, test } from 'vitest';
import { type PackedHarmonics, readCoefficients } from '../../data/packing/harmonics.ts';
import { ROW_SLOT } from '../../data/splats/splat-row.ts';
import { SH_REST_COEFFICIENTS, type SplatSet } from '../../data/splats/splat-set.ts';
import { rowsOf } from '../../testing/rows-of.ts';
import { readSplats } from '../loading/read-splats.ts';
import { encodePly } from './ply/write-ply.ts';

const SH_C0 = 0.28209479177387814;

const bytesOf = (name: string) => readFileSync(capturePath(name));
const read = (name: string) => readSplats(bytesOf(name), { shPrecision: 'f32', name });

function harmonicsOf({ harmonics }: SplatSet<PackedHarmonics>, index: number): Float64Array {
  const values = new Float64Array(3 * SH_REST_COEFFICIENTS[harmonics.degree]);
  readCoefficients(harmonics, index, values);
  return values;
}

describe.runIf(captures)('a real capture of 31,000 splats', () => {
  test('is read from its PLY as the bytes say, and is written back to the same bytes', async () => {
    const bytes = bytesOf('playbot-lod3.ply');
    const set = await read('playbot-lod3.ply');
    expect(set).toMatchObject({ count: 31_000, origin: [0, 0, 0], dropped: {}, harmonics: { degree: 2 } });
    const body = bytes.subarray(bytes.indexOf('end_header\n') + 11);
    for (const row of [0, 1, 12_345, 30_999]) {
      const columnOf = (column: Float32Array, width: number) =>
        column.subarray(width * row, width * (row + 1));
      const sh = harmonicsOf(set, row);
      const found = [
        ...columnOf(set.positions, 3),
        ...columnOf(set.rotations, 4),
        ...columnOf(set.logScales, 3),
        set.opacityLogits[row],
        ...columnOf(set.colorDc, 3),
        ...Array.from({ length: 24 }, (_, k) => sh[3 * (k % 8) + Math.floor(k / 8)]),
      ];
      expect(found).toEqual(found.map((_, i) => body.readFloatLE((row * 38 + i) * 4)));
    }
    const again = await readSplats(encodePly(set), { shPrecision: 'f32' });
    expect(Buffer.from(encodePly(again)).equals(encodePly(set))).toBe(true);
  });

  test('is read from its compressed PLY as from its PLY, within the steps of the format', async () => {
    const set = await read('playbot-lod3.compressed.ply');
    const truth = await read('playbot-lod3.ply');
    expect(set).toMatchObject({ count: 31_000, dropped: {}, harmonics: { degree: 2 } });
    // Its writer sorts splats. Where values differ by a step at most, so do those of the same rank.
    const sorted = (values: Float32Array, from: number, step: number) =>
      values.filter((_, i) => i % step === from).sort();
    const largest = (found: Float32Array, expected: Float32Array) =>
      found.reduce((most, value, i) => Math.max(most, Math.abs(value - expected[i])), 0);
    for (let axis = 0; axis < 3; axis++) {
      const levels = axis === 1 ? 1023 : 2047;
      for (const column of ['positions', 'logScales', 'colorDc'] as const) {
        const expected = sorted(truth[column], axis, 3);
        // No chunk's bounds are wider than those of all splats.
        const extent = expected[30_999] - expected[0];
        const bound = extent / (column === 'colorDc' ? 255 : levels) / 2 + 1e-5;
        expect(largest(sorted(set[column], axis, 3), expected), `${column} ${axis}`).toBeLessThan(bound);
      }
    }
    const opacities = (logits: Float32Array) => logits.map((logit) => 1 / (1 + Math.exp(-logit))).sort();
    expect(largest(opacities(set.opacityLogits), opacities(truth.opacityLogits))).toBeLessThan(
      1 / 255 / 2 + 1e-6,
    );
    const coefficients = ({ harmonics }: typeof set) => {
      const values = new Float32Array(24);
      return Float32Array.from({ length: 31_000 }, (_, i) => {
        readCoefficients(harmonics, i, values);
        return values[7];
      }).sort();
    };
    expect(largest(coefficients(set), coefficients(truth))).toBeLessThan(8 / 256 / 2 + 1e-6);
  });

  test('is read from its SOG as from its PLY, within the steps of its bytes', async () => {
    const sog = await rowsOf(bytesOf('playbot-lod3.sog'));
    expect(sog.layout).toMatchObject({ count: 31_000, shDegree: 2, isAntialiased: undefined });
    const ply = bytesOf('playbot-lod3.ply');
    const properties = [
      ...ply
        .toString('latin1', 0, 4096)
        .split('end_header')[0]
        .matchAll(/property float (\w+)/g),
    ];
    const truth = new Float32Array(Uint8Array.from(ply.subarray(ply.indexOf('end_header\n') + 11)).buffer);
    const columnOf = (name: string) => properties.findIndex(([, each]) => each === name);
    const names = [
      'x',
      'y',
      'z',
      'scale_0',
      'scale_1',
      'scale_2',
      'rot_0',
      'rot_1',
      'rot_2',
      'rot_3',
      'opacity',
    ];
    names.push('f_dc_0', 'f_dc_1', 'f_dc_2');
    for (let k = 0; k < 8; k++) names.push(`f_rest_${k}`, `f_rest_${8 + k}`, `f_rest_${16 + k}`);
    const columns = names.map(columnOf);
    expect(columns).not.toContain(-1);

    // The writer sorts splats: each is found by its position, in cells larger than its steps.
    const length = names.length;
    const cellOf = (x: number, y: number, z: number) =>
      (Math.round(x) * 8192 + Math.round(y)) * 8192 + Math.round(z);
    const perUnit = 2000;
    const cells = new Map<number, number[]>();
    for (let row = 0; row < 31_000; row++) {
      const at = row * properties.length;
      const [x, y, z] = columns.slice(0, 3).map((column) => perUnit * truth[at + column]);
      const cell = cellOf(x, y, z);
      cells.set(cell, [...(cells.get(cell) ?? []), at]);
    }
    const nearest = ([x, y, z]: Float32Array) => {
      let best = -1;
      let least = Number.POSITIVE_INFINITY;
      for (let i = 0; i < 27; i++) {
        const [dx, dy, dz] = [(i % 3) - 1, (Math.floor(i / 3) % 3) - 1, Math.floor(i / 9) - 1];
        for (const at of cells.get(cellOf(perUnit * x + dx, perUnit * y + dy, perUnit * z + dz)) ?? []) {
          const distance = Math.hypot(
            truth[at + columns[0]] - x,
            truth[at + columns[1]] - y,
            truth[at + columns[2]] - z,
          );
          if (distance < least) [best, least] = [at, distance];
        }
      }
      return best;
    };
    const worst = new Float64Array(length);
    const means = new Float64Array(length);
    const found = new Set<number>();
    const sigmoid = (logit: number) => 1 / (1 + Math.exp(-logit));
    // One in five, which takes a fifth of the time.
    for (let i = 0; i < 31_000; i += 5) {
      const row = sog.values.subarray(i * length, (i + 1) * length);
      const at = nearest(row);
      found.add(at);
      const values = columns.map((column) => truth[at + column]);
      const rotation = values.slice(6, 10);
      const largest = rotation.reduce((most, each) => (Math.abs(each) > Math.abs(most) ? each : most));
      const norm = Math.hypot(...rotation) * Math.sign(largest);
      for (let slot = 0; slot < length; slot++) {
        let error = Math.abs(row[slot] - values[slot]);
        if (slot >= 6 && slot < 10) error = Math.abs(row[slot] - values[slot] / norm);
        if (slot === ROW_SLOT.opacity) error = Math.abs(sigmoid(row[slot]) - sigmoid(values[slot]));
        worst[slot] = Math.max(worst[slot], error);
        means[slot] += error / 6200;
      }
    }
    expect(found.size).toBeGreaterThan(6190);
    // Positions: rounded down to steps of (max − min) / 65535 of ln(|v| + 1), stretched by e^0.74.
    const step = (1.43 / 65535) * Math.exp(0.74);
    for (let slot = 0; slot < 3; slot++) expect(worst[slot]).toBeLessThan(step);
    // Log scales, base colours: nearest of 256 values; half a step of 10 / 255 if they are even.
    for (let slot = 3; slot < 6; slot++) expect(means[slot]).toBeLessThan(0.02);
    for (let slot = 11; slot < 14; slot++) expect(means[slot]).toBeLessThan(0.02);
    // Rotations: rounded down to steps of √2 / 255; the largest follows from three such errors.
    for (let slot = 6; slot < 10; slot++) expect(worst[slot]).toBeLessThan((3 * Math.SQRT2) / 255);
    // Opacities: rounded down to a step of 1 / 255.
    expect(worst[ROW_SLOT.opacity]).toBeLessThan(1.001 / 255);
    // Harmonics: clustered, half as many as splats, without a bound; a wrong order is far off.
    for (let slot = ROW_SLOT.harmonics; slot < length; slot++) expect(means[slot]).toBeLessThan(0.006);
  });

  test('is read from its .splat as from its PLY, within the steps of the format', async () => {
    const set = await read('playbot-lod3.splat');
    const truth = await read('playbot-lod3.ply');
    expect(set).toMatchObject({ count: 31_000, dropped: {} });
    expect(set.positions).toEqual(truth.positions);
    let [scale, rotation, color, opacity] = [0, 0, 0, 0];
    for (let i = 0; i < 3 * 31_000; i++) {
      scale = Math.max(scale, Math.abs(set.logScales[i] - truth.logScales[i]));
      // Values that no byte can hold are clamped.
      const trained = Math.max(0, Math.min(1, truth.colorDc[i] * SH_C0 + 0.5));
      color = Math.max(color, Math.abs(set.colorDc[i] * SH_C0 + 0.5 - trained));
    }
    const sigmoid = (logit: number) => 1 / (1 + Math.exp(-logit));
    for (let i = 0; i < 31_000; i++) {
      const [found, trained] = [set, truth].map(({ rotations }) => {
        const parts = rotations.subarray(4 * i, 4 * i + 4);
        return parts.map((part) => part / Math.hypot(...parts));
      });
      const sign = Math.sign(found.reduce((sum, part, k) => sum + part * trained[k], 0));
      for (let k = 0; k < 4; k++) rotation = Math.max(rotation, Math.abs(sign * found[k] - trained[k]));
      opacity = Math.max(opacity, Math.abs(sigmoid(set.opacityLogits[i]) - sigmoid(truth.opacityLogits[i])));
    }
    expect(scale).toBeLessThan(1e-6);
    // The writer of this file cuts fractions off: a byte stands for up to one step more.
    expect(color).toBeLessThan(1 / 255 + 1e-6);
    expect(opacity).toBeLessThan(1 / 255 + 1e-6);
    // Four parts half a step off, and one step at 0, turn a rotation that is then normalized.
    expect(rotation).toBeLessThan(2 / 128);
  });

  test('is read from its SPZ as from its PLY, within the steps of the format', async () => {
    const [spz, ply] = await Promise.all([read('playbot-lod3.spz'), read('playbot-lod3.ply')]);
    expect(spz).toMatchObject({ count: 31_000, origin: [0, 0, 0], dropped: {}, harmonics: { degree: 2 } });
    let worst = { position: 0, logScale: 0, opacity: 0, color: 0, rotation: 0, harmonic1: 0, harmonic: 0 };
    const sigmoid = (logit: number) => 1 / (1 + Math.exp(-logit));
    const clamped = (value: number, most: number) => Math.max(-most, Math.min(most, value));
    const far = (a: number, b: number) => Math.abs(a - b);
    const note = (what: keyof typeof worst, error: number) => {
      if (!(error <= worst[what])) worst = { ...worst, [what]: error };
    };
    for (let i = 0; i < 3 * spz.count; i++) {
      note('position', far(spz.positions[i], ply.positions[i]));
      note('logScale', far(spz.logScales[i], ply.logScales[i]));
      note('color', far(spz.colorDc[i], clamped(ply.colorDc[i], 0.5 / 0.15)));
    }
    for (let row = 0; row < spz.count; row++) {
      note('opacity', far(sigmoid(spz.opacityLogits[row]), sigmoid(ply.opacityLogits[row])));
      const [a, b] = [spz, ply].map(({ rotations }) => rotations.subarray(4 * row, 4 * row + 4));
      const product = (p: Float32Array, q: Float32Array) =>
        p.reduce((sum, value, i) => sum + value * q[i], 0);
      const cosine = Math.abs(product(a, b)) / Math.sqrt(product(a, a) * product(b, b));
      note('rotation', 2 * Math.acos(Math.min(1, cosine)));
      const [from, to] = [harmonicsOf(ply, row), harmonicsOf(spz, row)];
      for (let i = 0; i < from.length; i++)
        note(i < 9 ? 'harmonic1' : 'harmonic', far(clamped(from[i], 1), to[i]));
    }
    // Half a step each. Positions are multiples of 2^-12, log scales of 1/16, opacities of 1/255.
    expect(worst.position).toBeLessThanOrEqual(2 ** -13);
    expect(worst.logScale).toBeLessThanOrEqual(1 / 32);
    expect(worst.opacity).toBeLessThanOrEqual(0.5 / 255 + 1e-7);
    // The colour of degree 0 times 0.15 is a multiple of 1/255.
    expect(worst.color).toBeLessThanOrEqual(0.5 / 255 / 0.15 + 1e-6);
    // Three components of steps of sqrt(1/2)/511 are off by half a step; the fourth one, at least
    // 1/2, by up to twice as much as they are together. The angle is twice the length of all that.
    const off = (Math.sqrt(3) * Math.SQRT1_2) / 511 / 2;
    expect(worst.rotation).toBeLessThanOrEqual(2 * Math.hypot(off, 2 * off));
    // Its writer keeps 5 bits of degree 1 and 4 of the others, of bytes for -1 to 1, 255 being 1.
    expect(worst.harmonic1).toBeLessThanOrEqual(4.5 / 128);
    expect(worst.harmonic).toBeLessThanOrEqual(8.5 / 128);
  });
});
