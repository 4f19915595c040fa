import { expect, test } from 'vitest';
import { allocatedBytes } from './allocation-meter.ts';

const kept: unknown[] = [];
const bytesOf = (make: () => unknown) => allocatedBytes(async () => kept.push(make()));

test.each<[string, () => unknown, number]>([
  ['a buffer', () => new ArrayBuffer(100), 100],
  ['a typed array', () => new Float64Array(100), 800],
  ['a typed array of values', () => Float32Array.of(1, 2, 3), 12],
  ['a copy', () => new Uint16Array(new Uint16Array(10)), 40],
  ['a slice', () => new Uint8Array(100).slice(60), 140],
  ['a part of a buffer', () => new ArrayBuffer(100).slice(60), 140],
  ['an array of a given length', () => new Array(100), 800],
  ['an array made of a length', () => Array.from({ length: 100 }, (_, i) => i), 800],
  ['a view, which takes none', () => new Uint8Array(new ArrayBuffer(100), 4).subarray(2), 100],
])('%s', async (_, make, bytes) => {
  expect(await bytesOf(make)).toBe(bytes);
});

test('objects are made as they would be otherwise, and all is put back', async () => {
  const before = [Uint8Array, Array, ArrayBuffer, Array.from, Uint8Array.prototype.slice];
  await allocatedBytes(async () => {
    const bytes = new Uint8Array(3);
    expect(bytes).toBeInstanceOf(Uint8Array);
    expect(ArrayBuffer.isView(bytes)).toBe(true);
    expect(Array.isArray(new Array(3))).toBe(true);
  });
  const failing = allocatedBytes(async () => {
    throw new Error('no');
  });
  await expect(failing).rejects.toThrow('no');
  expect([Uint8Array, Array, ArrayBuffer, Array.from, Uint8Array.prototype.slice]).toEqual(before);
});
