import { expect, test } from 'vitest';
import { measuredTables } from './pictures.ts';

test('tables tell what building and choosing take, and compare pictures share by share', () => {
  const near = { drawn: 50, dB: 31.26, 'filtered dB': 20 };
  const far = { drawn: 40, dB: Number.POSITIVE_INFINITY, 'filtered dB': 22 };
  const pictures = new Map([0.1, 0.3].map((dilationPx2) => [dilationPx2, [near, near, near, far]]));
  const ofShares = (choiceMs: number | null) => [
    { share: 0.5, choiceMs, pictures },
    { share: 0.06, choiceMs, pictures },
  ];
  const [times, compared] = measuredTables([
    { name: 'tree', buildMs: [300, 100], ofShares: ofShares(2) },
    { name: 'files', buildMs: [1000], ofShares: ofShares(null) },
  ]);
  expect(times.rows).toEqual([
    ['levels', 'building, s', 'choosing 50 %, ms', 'choosing 6 %, ms'],
    ['tree', '0.30, 0.10', '2.000', '2.000'],
    ['files', '1.00', '–', '–'],
  ]);
  const cells = '50|50|50|40|31.3|31.3|31.3|Infinity|20.0|20.0|20.0|22.0'.split('|');
  expect(compared.rows.slice(1)).toEqual([
    ['tree', '50 %', '0.1', ...cells],
    ['tree', '50 %', '0.3', ...cells],
    ['files', '50 %', '0.1', ...cells],
    ['files', '50 %', '0.3', ...cells],
    ['tree', '6 %', '0.1', ...cells],
    ['tree', '6 %', '0.3', ...cells],
    ['files', '6 %', '0.1', ...cells],
    ['files', '6 %', '0.3', ...cells],
  ]);
});
