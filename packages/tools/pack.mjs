// Packs the published packages into a folder, as they are published: `node packages/tools/pack.mjs
// FOLDER` prints a line per package with its name and the tarball's path.
//
// Tarballs differ from the packages' folders: pages of documentation are added, to which the links of
// READMEs lead, and export conditions for sources are left out, since sources are not packed.
import { execFile } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
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
  const { packedDocs } = await importPackedDocs();
  const aside = mkdtempSync(join(tmpdir(), 'websplatter-pack-'));
  try {
    const packed = PUBLISHED.map((name) => {
      const manifest = stage(name, join(aside, name), packedDocs(repositoryRoot, name));
      return { name: manifest.name, tarball: join(folder, `websplatter-${name}-${manifest.version}.tgz`) };
    });
    const folders = PUBLISHED.map((name) => `./${name}`);
    const args = ['pack', '--json', '--silent', '--ignore-scripts', '--pack-destination', folder, ...folders];
    const options = { cwd: aside, shell: process.platform === 'win32', maxBuffer: 64 << 20 };
    await promisify(execFile)('npm', args, options);
    return packed;
  } finally {
    rmSync(aside, { recursive: true, force: true });
  }
}

/** Imports `src/packed-docs.ts`, which Node 20 cannot run. */
export async function importPackedDocs() {
  const { runnerImport } = await import('vite');
  // Vite would choose development, also for later builds in this process.
  process.env.NODE_ENV ??= 'production';
  const source = join(repositoryRoot, 'packages/tools/src/packed-docs.ts');
  return (await runnerImport(source, { configFile: false, logLevel: 'error' })).module;
}

/** Writes the published files of a package to `folder`. Returns its manifest there. */
function stage(name, folder, docs) {
  const source = join(repositoryRoot, 'packages', name);
  const { files, exports, ...manifest } = JSON.parse(readFileSync(join(source, 'package.json'), 'utf8'));
  for (const file of ['LICENSE', 'CHANGELOG.md', ...files])
    cpSync(join(source, file), join(folder, file), { recursive: true });
  for (const [path, text] of docs) {
    mkdirSync(dirname(join(folder, path)), { recursive: true });
    writeFileSync(join(folder, path), text);
  }
  const staged = {
    ...manifest,
    files: [...files, 'docs', 'CHANGELOG.md'],
    exports: Object.fromEntries(
      Object.entries(exports).map(([entry, target]) => {
        if (typeof target === 'string') return [entry, target];
        const { '@websplatter/source': _, ...conditions } = target;
        return [entry, conditions];
      }),
    ),
  };
  writeFileSync(join(folder, 'package.json'), `${JSON.stringify(staged, null, 2)}\n`);
  return staged;
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  const folder = process.argv[2];
  if (folder === undefined) fail('No folder given. Usage: node packages/tools/pack.mjs FOLDER');
  const packed = await pack(resolve(folder)).catch((error) => fail(error.stderr || error.message));
  for (const { name, tarball } of packed) console.log(`${name} ${tarball}`);
}
