import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { capturePath } from './captures.ts';

const folder = fileURLToPath(new URL('.', import.meta.url));

test('a capture has its path in the folder', () => {
  expect(capturePath('captures.test.ts', folder)).toBe(fileURLToPath(import.meta.url));
});

test('a capture that the folder lacks is an error that names both', () => {
  expect(() => capturePath('robot.ply', folder)).toThrow(/no robot\.ply in .*testing, the folder/);
});
