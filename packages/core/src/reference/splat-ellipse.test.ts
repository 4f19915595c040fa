import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { binGrid } from '../data/layout/bin-grid.ts';
import { alphaAt, touchedBins, touchedTiles } from '../stages/tiles/tiles.reference.ts';
import { type EllipseRecord, splatEllipse } from './splat-ellipse.ts';

const ALPHA_CUTOFF = 1 / 255;
const SIZE_PX = 160;

/** Records of all sizes and slimness, in and around the image: from dilation to 1000 images. */
const records: fc.Arbitrary<EllipseRecord> = fc
  .record({
    x: fc.double({ min: -200, max: 360, noNaN: true }),
    y: fc.double({ min: -200, max: 360, noNaN: true }),
    angle: fc.oneof(fc.double({ min: 0, max: Math.PI, noNaN: true }), fc.constantFrom(0, Math.PI / 2, 1e-7)),
    minorPx: fc.double({ min: -0.25, max: 6, noNaN: true }).map((exponent) => 2 ** exponent),
    slimness: fc.double({ min: 0, max: 12, noNaN: true }).map((exponent) => 2 ** exponent),
    opacity: fc.oneof(
      fc.double({ min: 0, max: 1, noNaN: true }),
      fc.double({ min: 1, max: 1000, noNaN: true }),
    ),
  })
  .map(({ x, y, angle, minorPx, slimness, opacity }) => {
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const majorPx = minorPx * slimness;
    return {
      centerPx: [x, y],
      majorPx: [cos * majorPx, sin * majorPx],
      minorPx: [-sin * minorPx, cos * minorPx],
      color: [1, 1, 1, opacity],
    };
  });

/** Cells of a size that have a pixel where the record is drawn, by looking at every pixel. */
function drawnCells(record: EllipseRecord, sizePx: number, columns: number): Set<number> {
  const cells = new Set<number>();
  for (let y = 0; y < SIZE_PX; y++)
    for (let x = 0; x < SIZE_PX; x++)
      if (alphaAt(record, x, y) >= ALPHA_CUTOFF)
        cells.add(Math.floor(y / sizePx) * columns + Math.floor(x / sizePx));
  return cells;
}

describe('the ellipse of a splat', () => {
  test('touches every bin and every tile in which a pixel is drawn', () => {
    const grid = binGrid(SIZE_PX, SIZE_PX);
    fc.assert(
      fc.property(records, (record) => {
        const ellipse = splatEllipse(record, ALPHA_CUTOFF);
        const bins = touchedBins(ellipse, grid);
        const drawn = drawnCells(record, 64, grid.binColumns);
        for (const bin of drawn) expect(bins).toContain(bin);
        const columns = grid.binColumns * 8;
        const tiles = bins.flatMap((bin) => {
          const place = { column: bin % grid.binColumns, row: Math.floor(bin / grid.binColumns) };
          return touchedTiles(ellipse, place).map(
            (tile) => (place.row * 8 + Math.floor(tile / 8)) * columns + place.column * 8 + (tile % 8),
          );
        });
        for (const tile of drawnCells(record, 8, columns)) expect(tiles).toContain(tile);
      }),
      { numRuns: 150, seed: 12 },
    );
  });

  test('touches few tiles without drawn pixels', () => {
    // A tile may be touched between its pixel centres.
    const disc = { centerPx: [80, 80], majorPx: [9, 0], minorPx: [0, 9], color: [1, 1, 1, 1] };
    const ellipse = splatEllipse(disc, ALPHA_CUTOFF);
    const touched = touchedBins(ellipse, binGrid(SIZE_PX, SIZE_PX)).flatMap((bin) =>
      touchedTiles(ellipse, { column: bin % 3, row: Math.floor(bin / 3) }),
    ).length;
    const drawn = drawnCells(disc, 8, 24).size;
    expect(touched).toBeGreaterThanOrEqual(drawn);
    expect(touched).toBeLessThanOrEqual(drawn + 4);
  });

  test('does not exist below the cutoff', () => {
    const faint = { centerPx: [8, 8], majorPx: [9, 0], minorPx: [0, 9], color: [1, 1, 1, 0.003] };
    expect(splatEllipse(faint, ALPHA_CUTOFF)).toBeNull();
    expect(touchedBins(null, binGrid(8, 8))).toEqual([]);
    expect(touchedTiles(null, { column: 0, row: 0 })).toEqual([]);
  });
});
