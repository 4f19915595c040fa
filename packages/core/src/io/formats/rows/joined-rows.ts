import { agreedAntialiasing, type ShDegree } from '../../../data/splats/splat-set.ts';
import { type DecodedRows, rowLength } from './decoded-rows.ts';

/**
 * Rows of several parts, one part after another. Parts of lower degree are padded with zeros. The
 * antialias flag is defined if all parts agree.
 *
 * @param parts at least one; their origins are equal, or all absent.
 */
export function joinedRows(parts: readonly DecodedRows[]): DecodedRows {
  const shDegree = parts.reduce<ShDegree>(
    (degree, part) => (part.shDegree > degree ? part.shDegree : degree),
    0,
  );
  const length = rowLength(shDegree);
  const widened = parts.map((part) => (part.shDegree === shDegree ? part : widenedRows(part, length)));
  let index = 0;
  let done = 0;
  return {
    count: parts.reduce((sum, { count }) => sum + count, 0),
    shDegree,
    origin: parts[0].origin,
    isAntialiased: agreedAntialiasing(parts),
    decode(values, rowCount) {
      for (let row = 0; row < rowCount; ) {
        const part = widened[index];
        const rows = Math.min(rowCount - row, part.count - done);
        part.decode(values.subarray(row * length), rows);
        row += rows;
        done += rows;
        if (done === part.count) {
          index++;
          done = 0;
        }
      }
    },
  };
}

function widenedRows(rows: DecodedRows, length: number): DecodedRows {
  const narrow = rowLength(rows.shDegree);
  return {
    ...rows,
    byteHarmonics: undefined,
    decode(values, rowCount) {
      rows.decode(values, rowCount);
      // From the last row to the first: a row moves to where later rows were.
      for (let row = rowCount - 1; row >= 0; row--) {
        values.copyWithin(row * length, row * narrow, (row + 1) * narrow);
        values.fill(0, row * length + narrow, (row + 1) * length);
      }
    },
  };
}
