import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { TestFolder } from './test-folder.ts';

const bin = fileURLToPath(new URL('../bin/websplatter.js', import.meta.url));
const isBuilt = existsSync(new URL('../dist/main.js', import.meta.url));

/** The program as users start it, on what `npm run build` made. `npm test` builds first. */
const binTest = test.skipIf(!isBuilt && !process.env.CI);

function websplatter(...args: string[]) {
  const env = { ...process.env, WEBSPLATTER_DEBUG: undefined };
  const { status, stdout, stderr } = spawnSync(process.execPath, [bin, ...args], { encoding: 'utf8', env });
  return { status, stdout, stderr };
}

binTest('--help lists the commands that exist', () => {
  const { status, stdout, stderr } = websplatter('--help');
  expect([status, stderr]).toEqual([0, '']);
  expect(stdout).toContain('websplatter render SCENE');
  expect(stdout).toContain('websplatter info SCENE');
  expect(stdout).toContain('websplatter accuracy SCENE');
  expect(stdout).not.toContain('websplatter bench');
});

binTest('a bad file ends it with status 2 and one line', () => {
  const file = new TestFolder().write('bad.ply', 'ply\nformat ascii 1.0\nelement vertex x\nend_header\n');
  const { status, stdout, stderr } = websplatter('info', file, '--json');
  expect([status, stdout]).toEqual([2, '']);
  expect(stderr).toMatch(/^websplatter: \S+bad\.ply: [^\n]+\n$/);
});

binTest('info prints JSON', () => {
  const { status, stdout, stderr } = websplatter('info', new TestFolder().scene(), '--json');
  expect([status, stderr]).toEqual([0, '']);
  expect(JSON.parse(stdout).count).toBe(3);
});

binTest(
  'render draws on the GPU and ends',
  () => {
    const folder = new TestFolder();
    const out = folder.file('a.png');
    const { status, stderr } = websplatter(
      ...['render', folder.scene(), '--camera', folder.camera(), '--size', '32x32', '--out', out],
    );
    expect(stderr).toMatch(/^(note: [^\n]+\n)?$/);
    expect(status).toBe(0);
    expect(existsSync(out)).toBe(true);
  },
  60_000,
);
