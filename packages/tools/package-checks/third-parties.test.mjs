import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, test } from 'vitest';
import { PUBLISHED } from '../pack.mjs';
import { repositoryRoot } from '../setup.mjs';
import { installedBytes, thirdParties } from './third-parties.mjs';

const read = (path) => readFileSync(join(repositoryRoot, path), 'utf8');
const lock = JSON.parse(read('package-lock.json'));

/** Rows of the table: the dependency, the folders that need it, why, and the megabytes that it takes. */
const rows = [
  ...read('docs/dependencies.md').matchAll(/^\| `([^`]+)` \| ([^|]+) \| ([^|]+) \| ([\d.]+) \|$/gm),
].map(([, name, folders, reason, megabytes]) => ({
  name,
  folders: folders.replaceAll('`', '').split(', '),
  reason,
  megabytes: Number(megabytes),
}));

test('docs/dependencies.md lists what is needed at run time, by whom and why', () => {
  const listed = Object.fromEntries(rows.map(({ name, folders }) => [name, folders.sort()]));
  expect(listed).toEqual(Object.fromEntries(thirdParties(lock)));
  for (const { name, reason } of rows) expect(reason.length, name).toBeGreaterThan(20);
});

test.each(rows)('docs/dependencies.md says how many megabytes $name takes', ({ name, megabytes }) => {
  expect(Math.abs(installedBytes(lock, repositoryRoot, name) / 1e6 - megabytes)).toBeLessThan(
    Math.max(0.01, megabytes / 100),
  );
});

test('published packages need nothing but each other and their peers', () => {
  for (const folder of PUBLISHED) {
    const dependencies = Object.keys(lock.packages[`packages/${folder}`].dependencies ?? {});
    expect(dependencies.filter((name) => !name.startsWith('@websplatter/'))).toEqual([]);
  }
});
