import type { CloudFit, SceneFraming } from '@websplatter/core';
import { expect, test } from 'vitest';
import { fitNotice, framingNotice } from './scene-notices.ts';

const offersFor = (kind: SceneFraming['kind'], up: number, kindSure: number) =>
  framingNotice({ kind, confidence: { up, kind: kindSure } } as SceneFraming)?.offers.map(
    ({ command }) => command,
  );

test('what is uncertain in a first view is offered otherwise, and nothing else', () => {
  expect(offersFor('object', 0.5, 0.5)).toBeUndefined();
  expect(offersFor('object', 0.4, 0.9)).toEqual(['flip']);
  expect(offersFor('object', 0.9, 0.4)).toEqual(['inside']);
  expect(offersFor('enclosed', 0.9, 0.4)).toEqual(['outside']);
  expect(offersFor('surrounded', 0.4, 0.4)).toEqual(['outside', 'flip']);
});

const wanted = { geometryPrecision: 'f32', shPrecision: 'f32', shDegree: 3 } as const;
const bytes = { wantedBytes: 3e9, takenBytes: 1e9, why: '' };

test.each<[CloudFit['taken'], string]>([
  [{ ...wanted, shPrecision: 'f16' }, 'f16 harmonics'],
  [{ ...wanted, geometryPrecision: 'packed', shPrecision: 'u8' }, 'packed geometry and u8 harmonics'],
  [
    { geometryPrecision: 'packed', shPrecision: 'u8', shDegree: 1 },
    'packed geometry, u8 harmonics, and harmonics of degree 1 instead of 3',
  ],
])('names what is coarser: %o', (taken, words) => {
  expect(fitNotice('garden.ply', { wanted, taken, ...bytes })).toBe(
    `garden.ply needs 3.0 GB, more than the GPU has left. It is shown with ${words}, in 1.0 GB.`,
  );
});
