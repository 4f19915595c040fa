import { readFileSync } from 'node:fs';
import { join, posix } from 'node:path';
import { expect, test } from 'vitest';
import { PUBLISHED } from '../pack.mjs';
import { isInstalled, PROJECTS, repositoryRoot } from '../setup.mjs';
import { installedBytes, thirdParties } from './third-parties.mjs';

const read = (path) => readFileSync(join(repositoryRoot, path), 'utf8');
const lockOf = (folder) => JSON.parse(read(join(folder, 'package-lock.json')));
const rootLock = lockOf('.');
/** Of the repository, and of the apps that are not among its workspaces. */
const locks = { '.': rootLock, 'apps/docs': lockOf('apps/docs'), 'apps/examples': lockOf('apps/examples') };

/** Rows of the table: the dependency, the folders that need it, the reason, and its megabytes. */
const rows = [
  ...read('docs/dependencies.md').matchAll(/^\| `([^`]+)` \| ([^|]+) \| ([^|]+) \| ([\d.]+) \|$/gm),
].map(([, name, folders, reason, megabytes]) => ({
  name,
  folders: folders.replaceAll('`', '').split(', '),
  reason,
  megabytes: Number(megabytes),
  home: Object.keys(locks).find((folder) => {
    const entry = locks[folder].packages[`node_modules/${name}`];
    return entry && !entry.link;
  }),
}));

/** Those that are there. `npm run test:full` installs all. */
const installedRows = rows.filter(
  ({ home }) => process.env.WEBSPLATTER_FULL === '1' || isInstalled(home ?? '.'),
);

/**
 * @fault Pages and packages: a dependency at run time is not documented
 * @consequence the tests fail
 */
test('docs/dependencies.md lists what is needed at run time, by whom and why', () => {
  const listed = Object.fromEntries(rows.map(({ name, folders }) => [name, folders.sort()]));
  expect(listed).toEqual(Object.fromEntries(thirdParties(locks)));
  for (const { name, reason } of rows) expect(reason.length, name).toBeGreaterThan(20);
});

test.each(installedRows)(
  'docs/dependencies.md says how many megabytes $name takes',
  { tags: 'deeper' },
  ({ name, megabytes, home }) => {
    const bytes = installedBytes(locks[home], join(repositoryRoot, home), name);
    expect(Math.abs(bytes / 1e6 - megabytes)).toBeLessThan(Math.max(0.01, megabytes / 100));
  },
);

test('published packages need nothing but each other and their peers', () => {
  for (const folder of PUBLISHED) {
    const dependencies = Object.keys(rootLock.packages[`packages/${folder}`].dependencies ?? {});
    expect(dependencies.filter((name) => !name.startsWith('@websplatter/'))).toEqual([]);
  }
});

test.each(['.', ...Object.keys(PROJECTS)])('the lock of %s has no addresses of a registry', (folder) => {
  expect(read(join(folder, 'package-lock.json'))).not.toMatch(/"resolved": "\w+:/);
});

test('React, three and Vite are there once: projects apart from the workspaces link to the root’s, in its versions', () => {
  const single = ['react', 'react-dom', 'three', '@types/three', '@react-three/fiber', 'vite'];
  // Their pages are built with a three of their own.
  const { 'apps/lab/peers': _, 'e2e/three/oldest': __, ...projects } = PROJECTS;
  for (const project of Object.keys(projects)) {
    for (const [path, { link, version }] of Object.entries(lockOf(project).packages)) {
      const name = path.replace(/^(?:\.\.\/)*node_modules\//, '');
      if (single.includes(name) && path.startsWith('node_modules/'))
        expect(link, `${project}: ${name}`).toBe(true);
      if (!path.startsWith('..')) continue;
      const target = posix.join(project, path);
      expect(version, `${project}: ${target}`).toBe(rootLock.packages[target].version);
    }
  }
});
