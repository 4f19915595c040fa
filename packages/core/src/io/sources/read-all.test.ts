import { expect, test } from 'vitest';
import { chunked } from '../../testing/ply-fixture.ts';
import { ByteReader } from './byte-reader.ts';
import { readAll } from './read-all.ts';

const bytes = Uint8Array.from({ length: 3_000_000 }, (_, i) => i * 7);
const readerOf = () => new ByteReader({ name: 'scene.zip', stream: chunked(bytes, [700_000]) });

test.each([0, 3_000_000, 1000])('all bytes arrive, with %i expected', async (expectedBytes) => {
  const read = await readAll(readerOf(), undefined, expectedBytes);
  expect(Buffer.compare(read, bytes)).toBe(0);
});

test('it stops after as many bytes as it may read', async () => {
  const read = await readAll(readerOf(), 1_500_000);
  expect(Buffer.compare(read, bytes.subarray(0, 1_500_000))).toBe(0);
});

test('files that no memory can hold are refused by name', async () => {
  await expect(readAll(readerOf(), undefined, 2 ** 50)).rejects.toMatchObject({
    code: 'too-large',
    file: 'scene.zip',
    message: expect.stringMatching(/no memory for 1125899906842624 bytes/),
  });
});
