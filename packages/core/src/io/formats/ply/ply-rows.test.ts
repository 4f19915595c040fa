import { expect, test } from 'vitest';
import { randomSplats } from '../../../testing/random-splats.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { openPlyRows } from './ply-rows.ts';
import { encodePly } from './write-ply.ts';

const set = randomSplats({ count: 50, shDegree: 1 });

/** The PLY with another header, whose body may begin with other bytes. */
function changed(change: (header: string) => string, before: readonly number[] = []): File {
  const bytes = encodePly(set);
  const end = new TextDecoder('latin1').decode(bytes).indexOf('end_header\n') + 'end_header\n'.length;
  const header = change(new TextDecoder().decode(bytes.subarray(0, end)));
  return new File([header, Uint8Array.from(before), bytes.subarray(end)], 'a.ply');
}

test.each([
  ['as written', changed((header) => header)],
  [
    'with another element before, comments and CR LF',
    changed(
      (header) =>
        header
          .replace(
            'element vertex',
            'comment element vertex 7\nelement camera 3\nproperty ushort id\nelement vertex',
          )
          .replaceAll('\n', '\r\n'),
      [1, 2, 3, 4, 5, 6],
    ),
  ],
])('any rows of a PLY %s are a PLY', async (_, file) => {
  const rows = await openPlyRows(file, 'a.ply');
  expect(rows).toMatchObject({ count: 50, strideBytes: (14 + 9) * 4, shDegree: 1 });
  const read = await readSplats(
    rows.fileOf([
      [3, 2],
      [40, 10],
    ]),
    { shPrecision: 'f32' },
  );
  const indices = [3, 4, ...Array.from({ length: 10 }, (_, i) => 40 + i)];
  expect(read.count).toBe(12);
  expect(read.positions).toEqual(
    Float32Array.from(indices.flatMap((i) => [...set.positions.subarray(3 * i, 3 * i + 3)])),
  );
  expect(read.opacityLogits).toEqual(Float32Array.from(indices, (i) => set.opacityLogits[i]));
});

test.each([
  ['unknown-format', changed((header) => header.replace('binary_little_endian', 'ascii'))],
  ['unknown-format', changed((header) => header.replace('f_dc_0', 'red'))],
  [
    'unknown-format',
    changed((header) => header.replace('end_header', 'property list uchar int ids\nend_header')),
  ],
  ['truncated', changed((header) => header.replace('vertex 50', 'vertex 51'))],
  ['bad-header', new File(['no ply\n'], 'a.ply')],
])('what cannot be read in parts is refused: %s', async (code, file) => {
  await expect(openPlyRows(file, 'a.ply')).rejects.toMatchObject({ name: 'SplatFileError', code });
});
