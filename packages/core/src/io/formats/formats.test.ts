import { expect, test } from 'vitest';
import documentation from '../../../../../docs/formats.md?raw';
import { detectFormat } from './detect.ts';
import { BRICKS_MAGIC, FRAMES_MAGIC } from './first-bytes.ts';
import { FORMAT_TITLES, SPLAT_FORMATS } from './formats.ts';
import { ALL_READERS } from './readers.ts';
import { WRITABLE_FORMATS } from './writable-formats.ts';

test('people are told of common formats first, and of archives last', () => {
  expect(FORMAT_TITLES.slice(0, 4)).toEqual(['PLY', 'SPZ', 'SOG', 'glTF']);
  expect(FORMAT_TITLES.slice(-2)).toEqual(['zip', 'gzip']);
});

/** Cells of the first table of docs/formats.md, row by row, without its head. */
const ROWS = documentation
  .split('| format | files | read | written |')[1]
  .split('\n\n')[0]
  .split('\n')
  .slice(2)
  .map((row) => row.split('|').map((cell) => cell.trim()));

test('every format that is read has code, and a row with its files in docs/formats.md', () => {
  const code = Object.keys(import.meta.glob('./*/read-*.ts'));
  expect(ROWS).toHaveLength(SPLAT_FORMATS.length);
  for (const { name, extensions } of SPLAT_FORMATS) {
    expect(code).toContain(`./${name}/read-${name}.ts`);
    expect(
      ROWS.some(([, , files]) => files.includes(`${extensions[0]}\``)),
      name,
    ).toBe(true);
  }
});

test('docs/formats.md tells which formats are written, in the order of pickers, and where', () => {
  // Frames are written by a writer of their own.
  const written = ROWS.filter(([, , , , isWritten]) => isWritten !== '–' && !isWritten.startsWith('frames'));
  expect(written.map(([, title]) => title.replace(/\[(.*)\].*/, '$1'))).toEqual(
    WRITABLE_FORMATS.map(({ title }) => title),
  );
  expect(documentation.match(/^\*\*Written:\*\*/gm)).toHaveLength(WRITABLE_FORMATS.length);
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
  ['frames', `${FRAMES_MAGIC}\x01\0\0\0`],
  ['splat', '\xff'.repeat(32)],
])('first bytes of %s count for more than the name of a .splat', (name, text) => {
  const firstBytes = Buffer.from(text, 'latin1');
  expect(detectFormat(firstBytes, 'a', ['a.splat']).name).toBe(name);
  expect(ALL_READERS.pick(firstBytes, 'a', ['a.splat'])).toBeTypeOf('function');
});
