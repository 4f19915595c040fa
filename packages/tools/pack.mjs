// Packs the published packages into a folder, as npm would publish them: `node
// packages/tools/pack.mjs FOLDER` prints a line per package with its name and the tarball's path.
import { execFile } from 'node:child_process';
import { mkdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { promisify } from 'node:util';
import { build } from './build.mjs';
import { fail, repositoryRoot } from './setup.mjs';

/** Published packages (folders in packages/) in order of dependence; the others are internal. */
export const PUBLISHED = ['core', 'scenes', 'three', 'react'];

/**
 * Builds the packages and packs them into `folder`. Resolves with the name and the tarball's path
 * of each.
 */
export async function pack(folder) {
  await build();
  mkdirSync(folder, { recursive: true });
  const workspaces = PUBLISHED.flatMap((name) => ['--workspace', `packages/${name}`]);
  const args = [
    'pack',
    '--json',
    '--silent',
    '--ignore-scripts',
    '--pack-destination',
    folder,
    ...workspaces,
  ];
  const options = { cwd: repositoryRoot, shell: process.platform === 'win32', maxBuffer: 64 << 20 };
  await promisify(execFile)('npm', args, options);
  return PUBLISHED.map((name) => {
    const { version, ...manifest } = JSON.parse(
      readFileSync(join(repositoryRoot, 'packages', name, 'package.json'), 'utf8'),
    );
    return { name: manifest.name, tarball: join(folder, `websplatter-${name}-${version}.tgz`) };
  });
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  const folder = process.argv[2];
  if (folder === undefined) fail('No folder given. Usage: node packages/tools/pack.mjs FOLDER');
  const packed = await pack(resolve(folder)).catch((error) => fail(error.stderr || error.message));
  for (const { name, tarball } of packed) console.log(`${name} ${tarball}`);
}
