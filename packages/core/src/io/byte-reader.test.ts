import { getEventListeners } from 'node:events';
import { expect, test } from 'vitest';
import { chunked } from '../testing/ply-fixture.ts';
import { ByteReader } from './byte-reader.ts';

const numbers = (count: number) => Uint8Array.from({ length: count }, (_, i) => i * 7);
const readerOf = (bytes: Uint8Array, sizes: number[], signal?: AbortSignal) =>
  new ByteReader({ name: 'test', stream: chunked(bytes, sizes) }, signal);

test('fill, advance, skip and byteOffset agree with the bytes, whatever the chunks', async () => {
  const bytes = numbers(3_000_000);
  for (const sizes of [[1_000_000], [70_001, 3], [5_000_000]]) {
    const reader = readerOf(bytes, sizes);
    let offset = 0;
    for (const [take, skip] of [
      [1, 0],
      [1000, 999_999],
      [1_500_000, 17],
      [200_000, 1],
    ]) {
      expect(await reader.fill(take)).toBe(true);
      expect(reader.byteOffset).toBe(offset);
      expect(reader.bytes[reader.start]).toBe(bytes[offset]);
      expect(reader.view.getUint8(reader.start + take - 1)).toBe(bytes[offset + take - 1]);
      reader.advance(take);
      expect(await reader.skip(skip)).toBe(true);
      offset += take + skip;
    }
    expect(await reader.fill(bytes.length)).toBe(false);
    expect(reader.available).toBe(bytes.length - offset);
    expect(await reader.skip(bytes.length)).toBe(false);
  }
});

test('readInto gives the next bytes past the window, and tells of each part', async () => {
  const bytes = numbers(2_500_000);
  for (const sizes of [[1_000_000], [70_001, 3], [5_000_000]]) {
    const reader = readerOf(bytes, sizes);
    await reader.fill(10);
    reader.advance(4);
    const offsets: number[] = [];
    const target = new Uint8Array(2_000_000);
    expect(await reader.readInto(target, () => offsets.push(reader.byteOffset))).toBe(true);
    expect(Buffer.compare(target, bytes.subarray(4, 2_000_004))).toBe(0);
    expect(offsets.at(-1)).toBe(2_000_004);
    expect(offsets).toEqual(offsets.toSorted((a, b) => a - b));
    expect(await reader.fill(6)).toBe(true);
    expect(reader.bytes[reader.start]).toBe(bytes[2_000_004]);
    expect(await reader.readInto(new Uint8Array(500_000), () => {})).toBe(false);
  }
});

test('rest gives everything that was not passed over', async () => {
  const bytes = numbers(2_500_000);
  const reader = readerOf(bytes, [2_000_000, 1]);
  await reader.fill(10);
  reader.advance(4);
  const rest = new Uint8Array(await new Response(reader.rest()).arrayBuffer());
  expect(Buffer.compare(rest, bytes.subarray(4))).toBe(0);
});

test('a signal that outlives the read keeps no listener', async () => {
  const { signal } = new AbortController();
  const reader = readerOf(numbers(10), [3], signal);
  expect(getEventListeners(signal, 'abort')).toHaveLength(1);
  expect(await reader.skip(11)).toBe(false);
  expect(getEventListeners(signal, 'abort')).toHaveLength(0);
});
