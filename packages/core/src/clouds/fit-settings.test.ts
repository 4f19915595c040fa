import { expect, test } from 'vitest';
import { cloudBytes, coarserSettings } from './fit-settings.ts';

test('settings get coarser step by step, and every step takes fewer bytes', () => {
  const wanted = { geometryPrecision: 'f32', shPrecision: 'f32', shDegree: 3 } as const;
  const coarser = coarserSettings(wanted);
  expect(coarser.map(({ geometryPrecision, ...sh }) => [geometryPrecision, ...Object.values(sh)])).toEqual([
    ['f32', 'f16', 3],
    ['f32', 'u8', 3],
    ['packed', 'u8', 3],
    ['packed', 'u8', 2],
    ['packed', 'u8', 1],
    ['packed', 'u8', 0],
  ]);
  const bytes = [wanted, ...coarser].map((settings) => cloudBytes(1000, settings));
  expect(bytes).toEqual(bytes.toSorted((a, b) => b - a));
  expect(new Set(bytes).size).toBe(bytes.length);
});

test('a cloud without harmonics can only have its geometry packed', () => {
  expect(coarserSettings({ geometryPrecision: 'f32', shPrecision: 'f32', shDegree: 0 })).toEqual([
    { geometryPrecision: 'packed', shPrecision: 'f32', shDegree: 0 },
  ]);
  expect(coarserSettings({ geometryPrecision: 'packed', shPrecision: 'u8', shDegree: 0 })).toEqual([]);
});
