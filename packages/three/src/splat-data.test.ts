import { InvalidArgumentError, type SplatEngine } from '@websplatter/core';
import { expect, test } from 'vitest';
import { splatDataAt } from './testing/test-clouds.ts';

test('data of another precision says how to load it', () => {
  const engine = { accuracy: { geometryPrecision: 'f32' } } as unknown as SplatEngine;
  const acquire = () => splatDataAt([0, 0, 0]).acquire(engine);
  expect(acquire).toThrow(InvalidArgumentError);
  expect(acquire).toThrow(/packed geometry.*f32.*setAccuracy/);
});

test('a release too many frees nothing twice', () => {
  const data = splatDataAt([0, 0, 0]);
  expect(() => data.release({} as SplatEngine)).not.toThrow();
});
