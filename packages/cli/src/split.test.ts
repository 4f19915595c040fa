import { randomBytes } from 'node:crypto';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { writeSplats } from '@websplatter/core/write';
import { expect, test } from 'vitest';
import { runMain, TestFolder, threeSplats } from './testing/test-folder.ts';

const PIECE_BYTES = 4 << 20;

test('a file is cut into pieces, which together are that file', async () => {
  const folder = new TestFolder();
  const content = Buffer.concat([Buffer.from('WSBRICKS'), randomBytes(2 * PIECE_BYTES)]);
  const { status, out } = await runMain('split', folder.write('a.bricks', content), folder.file('x/y'));
  expect([status, out]).toEqual([
    0,
    `${folder.file('x/y/a.bricks.000')}: 3 pieces, ${content.length} bytes\n`,
  ]);
  const names = readdirSync(folder.file('x/y'));
  expect(names).toEqual(['a.bricks.000', 'a.bricks.001', 'a.bricks.002']);
  const pieces = names.map((name) => readFileSync(folder.file(join('x/y', name))));
  expect(pieces.map(({ length }) => length)).toEqual([PIECE_BYTES, PIECE_BYTES, 8]);
  expect(Buffer.concat(pieces).equals(content)).toBe(true);
});

test('a scene in pieces is read by the path of the first', async () => {
  const folder = new TestFolder();
  const file = await writeSplats(threeSplats(), 'bricks');
  const whole = folder.write('a.bricks', file);
  expect((await runMain('split', whole, folder.path)).status).toBe(0);
  const [first] = [folder.file('a.bricks.000')];
  // As if it were cut into smaller ones.
  const content = readFileSync(first);
  writeFileSync(first, content.subarray(0, 200));
  writeFileSync(folder.file('a.bricks.001'), content.subarray(200));
  const infoOf = async (path: string) => JSON.parse((await runMain('info', path, '--json')).out);
  expect(await infoOf(first)).toEqual({ ...(await infoOf(whole)), scene: first });
});

test('what cannot be cut is refused', async () => {
  const folder = new TestFolder();
  const scene = folder.write('a.bricks', await writeSplats(threeSplats(), 'bricks'));
  const outcomeOf = async (...args: string[]) => (await runMain('split', ...args)).err;
  expect(await outcomeOf(scene)).toContain('split needs an IN.bricks and a FOLDER, found 1');
  expect(await outcomeOf(folder.file('b.bricks'), folder.path)).toContain('there is no such file');
  expect(await outcomeOf(folder.scene(), folder.path)).toContain('it is no .bricks file');
  expect(await outcomeOf(scene, scene)).toContain('cannot be made');
  folder.write('a.bricks.001', 'old');
  expect(await outcomeOf(scene, folder.path)).toContain('a.bricks.001 is of a larger scene');
  expect(readdirSync(folder.path)).not.toContain('a.bricks.000');
});
