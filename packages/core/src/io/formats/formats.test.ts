import { expect, test } from 'vitest';
import { detectFormat } from './detect.ts';
import { FORMAT_TITLES } from './formats.ts';

test('people are told of common formats first, and of archives last', () => {
  expect(FORMAT_TITLES).toEqual(['PLY', 'SPZ', 'SOG', 'glTF', '.splat', '.ksplat', 'zip', 'gzip']);
});

test.each([
  ['zip', 'PK\x03\x04'],
  ['gzip', '\x1f\x8b\x08\0'],
  ['ksplat', `\0\x01\0\0${'\x01'.repeat(16)}\x01\0${'\x01'.repeat(22)}${'\0'.repeat(4052)}`],
  ['ply', 'ply\nformat ascii 1.0\n'],
  ['spz', 'NGSP\x04\0\0\0'],
  ['gltf', 'glTF\x02\0\0\0'],
  ['splat', '\xff'.repeat(32)],
])('what is %s by its first bytes is so under the name of a .splat', (name, text) => {
  expect(detectFormat(Buffer.from(text, 'latin1'), 'a', 'a.splat').name).toBe(name);
});
