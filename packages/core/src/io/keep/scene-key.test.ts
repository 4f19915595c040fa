import { expect, test } from 'vitest';
import { sceneKey } from './keep-bricks.ts';

const BYTES = new Uint8Array(1 << 20);
const keyOf = (change: { byte?: number; name?: string; lastModified?: number; size?: number }) => {
  const { byte, name = 'a.ply', lastModified = 1, size = BYTES.length } = change;
  const bytes = BYTES.slice(0, size);
  if (byte !== undefined) bytes[byte] = 1;
  return sceneKey(new File([bytes], name, { lastModified }));
};

test('a key is the same for the same file, and another for any other', async () => {
  const key = await keyOf({});
  expect(key).toMatch(/^[0-9a-f]{32}$/);
  expect(await keyOf({})).toBe(key);
  const others = await Promise.all([
    keyOf({ name: 'b.ply' }),
    keyOf({ lastModified: 2 }),
    keyOf({ size: BYTES.length - 1 }),
    keyOf({ byte: 0 }),
    keyOf({ byte: BYTES.length / 2 }),
    keyOf({ byte: BYTES.length - 1 }),
    keyOf({ size: 3 }),
    keyOf({ size: 0 }),
  ]);
  expect(new Set([key, ...others]).size).toBe(9);
});
