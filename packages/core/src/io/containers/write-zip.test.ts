import { expect, test } from 'vitest';
import { ByteReader } from '../sources/byte-reader.ts';
import { readAll } from '../sources/read-all.ts';
import { zipFiles } from './write-zip.ts';
import { openZipEntry, readZipDirectory } from './zip.ts';

test('files come back by their names', async () => {
  const files: Record<string, Uint8Array> = {
    'meta.json': new TextEncoder().encode('{}'),
    'images/größe.webp': Uint8Array.from({ length: 300_000 }, (_, i) => i * i),
    empty: new Uint8Array(0),
  };
  const zip = zipFiles(files);
  const entries = readZipDirectory(zip, 'a.zip');
  expect(entries.map(({ path }) => path)).toEqual(Object.keys(files));
  for (const entry of entries) {
    // CRC-32 and length are checked.
    const reader = new ByteReader(openZipEntry(zip, entry, entry.path));
    expect(Buffer.compare(await readAll(reader, 1e6), files[entry.path])).toBe(0);
  }
  expect(Buffer.compare(zipFiles(files), zip)).toBe(0);
});

test('an archive without files', () => {
  expect(readZipDirectory(zipFiles({}), 'a.zip')).toEqual([]);
});

/**
 * @fault Saved files: a path in an archive that is written leads out of its folder
 * @consequence `InvalidArgumentError`
 */
test.each(['../a', '/a', 'a/..', 'a\\..\\..\\b', 'C:a', 'a\0'])('a file at %j is refused', (path) => {
  expect(() => zipFiles({ 'meta.json': new Uint8Array(0), [path]: new Uint8Array(1) })).toThrow(
    "which may lie outside of the archive's folder",
  );
});
