import { expect, test } from 'vitest';
import documentation from '../../../../../docs/formats.md?raw';
import { detectFormat } from './detect.ts';
import { BRICKS_MAGIC } from './first-bytes.ts';
import { FORMAT_TITLES, SPLAT_FORMATS } from './formats.ts';
import { ALL_READERS } from './readers.ts';
import { WRITABLE_FORMATS } from './writable-formats.ts';

test('people are told of common formats first, and of archives last', () => {
  expect(FORMAT_TITLES.slice(0, 4)).toEqual(['PLY', 'SPZ', 'SOG', 'glTF']);
  expect(FORMAT_TITLES.slice(-2)).toEqual(['zip', 'gzip']);
});

/** Rows of a table of docs/formats.md, without its head. */
const rowsBelow = (head: string) => documentation.split(head)[1].split('\n\n')[0].split('\n').slice(2);

test('every format that is read has code, and a row with its files in docs/formats.md', () => {
  const code = Object.keys(import.meta.glob('./*/read-*.ts'));
  const rows = rowsBelow('| format | files | read | not read |');
  expect(rows).toHaveLength(SPLAT_FORMATS.length);
  for (const { name, extensions } of SPLAT_FORMATS) {
    expect(code).toContain(`./${name}/read-${name}.ts`);
    expect(
      rows.some((row) => row.split('|')[2].includes(`${extensions[0]}\``)),
      name,
    ).toBe(true);
  }
});

test('every format that is written has a row in docs/formats.md, in the order of pickers', () => {
  const rows = rowsBelow('| format | order | loss: half of a step |');
  expect(rows).toHaveLength(WRITABLE_FORMATS.length);
  for (const [i, { title }] of WRITABLE_FORMATS.entries())
    expect(rows[i].toLowerCase()).toMatch(new RegExp(`^\\| ${title.toLowerCase()}\\b`));
});

test.each([
  ['zip', 'PK\x03\x04'],
  ['gzip', '\x1f\x8b\x08\0'],
  ['ksplat', `\0\x01\0\0${'\x01'.repeat(16)}\x01\0${'\x01'.repeat(22)}${'\0'.repeat(4052)}`],
  ['ply', 'ply\nformat ascii 1.0\n'],
  ['spz', 'NGSP\x04\0\0\0'],
  ['gltf', 'glTF\x02\0\0\0'],
  ['rad', 'RAD0\x02\0\0\0{}'],
  ['bricks', `${BRICKS_MAGIC}\x01\0\0\0`],
  ['splat', '\xff'.repeat(32)],
])('first bytes of %s count for more than the name of a .splat', (name, text) => {
  const firstBytes = Buffer.from(text, 'latin1');
  expect(detectFormat(firstBytes, 'a', ['a.splat']).name).toBe(name);
  expect(ALL_READERS.pick(firstBytes, 'a', ['a.splat'])).toBeTypeOf('function');
});
