import { expect, test } from 'vitest';
import { decodeDataUri, isDataUri } from './gltf-buffers.ts';

test('base64 of any length and any bytes, padded or not', () => {
  for (let length = 0; length < 300; length += length < 8 ? 1 : 61) {
    const bytes = Uint8Array.from({ length }, (_, i) => 37 * i + 5);
    const base64 = Buffer.from(bytes).toString('base64');
    expect(decodeDataUri(`data:application/octet-stream;base64,${base64}`)).toEqual(bytes);
    expect(decodeDataUri(`DATA:;base64,${base64.replace(/=+$/, '')}`)).toEqual(bytes);
  }
});

test.each([
  'data:text/plain,AAAA',
  'data:;base64',
  'data:;base64,A',
  'data:;base64,AA-A',
  'data:;base64,AAé',
  'x',
])('%j is not decoded', (uri) => {
  expect(isDataUri(uri)).toBe(uri !== 'x');
  expect(decodeDataUri(uri)).toBeNull();
});
