import { encodePly, InvalidArgumentError, type SplatSet } from '@websplatter/core';
import { GaussianSplatPLYLoader } from 'three/addons/loaders/GaussianSplatPLYLoader.js';
import { BufferAttribute, BufferGeometry } from 'three/webgpu';
import { describe, expect, test } from 'vitest';
import { fakeEngine } from '../testing/fake-engine.ts';
import { splatSetAt } from '../testing/test-clouds.ts';
import { makeSplatData } from './make-splat-data.ts';

const ARRAYS = {
  positions: [0, 0, 0, 1, 2, 3],
  scales: [0.1, 0.2, 0.3, 0.1, 0.1, 0.1],
  colors: [1, 0, 0, 0, 1, 0],
};

describe('data of splats in memory', () => {
  test('have the count and the bounds of their arrays, and a name for messages', () => {
    const data = makeSplatData(ARRAYS, { name: 'dots' });
    expect([data.name, data.count, data.bounds.max.toArray()]).toEqual(['dots', 2, [1, 2, 3]]);
    expect(() => makeSplatData({ ...ARRAYS, scales: [1] })).toThrow(InvalidArgumentError);
  });

  test('are packed for an accuracy, and stay in memory for others', () => {
    const { engine, addPacked } = fakeEngine();
    const set = splatSetAt([0, 0, 0], [Number.NaN, 0, 0]);
    const data = makeSplatData(set, { accuracy: 'high' });
    data.acquire(engine, {});
    const [packed, options] = addPacked.mock.calls[0];
    expect([packed.count, packed.geometry.precision]).toEqual([1, 'f32']);
    expect(options?.source).toBe(set);
    expect(() => makeSplatData(set, { accuracy: 'best' as never })).toThrow(InvalidArgumentError);
  });
});

describe('geometries of three’s splat loaders', () => {
  const SPLATS: SplatSet = {
    ...splatSetAt([0.5, -1, 2], [3, 4, -5], [0, 0, 1]),
    logScales: Float32Array.of(-1, -2, -3, -2, -2.5, -2.2, -3, -1, -2),
    rotations: Float32Array.of(1, 0, 0, 0, 0.9, 0.1, -0.3, 0.2, -0.2, 0.5, 0.5, 0.1),
    opacityLogits: Float32Array.of(1, -1, 3),
    colorDc: Float32Array.of(0.2, -0.3, 0.5, 1, -1, 0, 0, 0, 0),
    harmonics: {
      degree: 3,
      coefficients: Float32Array.from({ length: 3 * 45 }, (_, i) => Math.sin(i) / 2),
    },
  };
  const geometry = () => new GaussianSplatPLYLoader().parse(encodePly(SPLATS).buffer as ArrayBuffer);

  test('have the splats of the file, as three rounds them', () => {
    const { set, count } = makeSplatData(geometry());
    expect(count).toBe(3);
    expect([...set!.positions]).toEqual([...SPLATS.positions]);
    for (const [i, value] of SPLATS.colorDc.entries())
      expect(Math.abs(set!.colorDc[i] - value)).toBeLessThan(0.01);
    for (const [i, logit] of SPLATS.opacityLogits.entries())
      expect(set!.opacityLogits[i]).toBeCloseTo(logit, 1);
    const { coefficients } = set!.harmonics;
    expect(coefficients).toHaveLength(SPLATS.harmonics.coefficients.length);
    for (const [i, value] of SPLATS.harmonics.coefficients.entries())
      expect(Math.abs(coefficients[i] - value)).toBeLessThanOrEqual(1 / 128);
    // The largest axis comes first.
    const logScales = [0, 1, 2].flatMap((i) =>
      [...SPLATS.logScales.subarray(3 * i, 3 * i + 3)].sort((a, b) => b - a),
    );
    for (const [i, value] of logScales.entries()) expect(set!.logScales[i]).toBeCloseTo(value, 3);
  });

  test('without an attribute of such a geometry are refused by its name', () => {
    const plain = new BufferGeometry();
    expect(() => makeSplatData(plain)).toThrow('attribute position is missing');
    plain.setAttribute('position', new BufferAttribute(new Float32Array(6), 3));
    expect(() => makeSplatData(plain)).toThrow('attribute covariance is missing');
    const wrong = geometry();
    wrong.setAttribute('color', new BufferAttribute(new Uint8Array(9), 3, true));
    expect(() => makeSplatData(wrong)).toThrow('attribute color is 3 × 3 values');
  });
});
