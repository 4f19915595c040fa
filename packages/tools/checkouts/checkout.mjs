import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, readdirSync, readFileSync, realpathSync } from 'node:fs';
import { join, resolve } from 'node:path';

const PACKAGES = ['core', 'node', 'scenes'];

/**
 * A folder with built packages.
 *
 * @throws Error naming what is not there.
 */
export function findCheckout(path) {
  const folder = resolve(path);
  for (const name of PACKAGES) {
    const entry = join(folder, 'packages', name, 'dist/index.js');
    if (!existsSync(entry)) throw new Error(`${entry} is missing: run npm run build in ${folder} first.`);
  }
  return { path, folder: realpathSync(folder) };
}

/** What was run: commit, and a hash of the built files, which may be older or newer than the commit. */
export function describeCheckout({ folder }) {
  return `${commitOf(folder) ?? 'no commit'}, dist ${distHash(folder).slice(0, 12)}`;
}

function distHash(folder) {
  const hash = createHash('sha256');
  for (const name of PACKAGES) {
    const dist = join(folder, 'packages', name, 'dist');
    const files = readdirSync(dist).filter((file) => file.endsWith('.js'));
    for (const file of files.sort()) hash.update(`${name}/${file}\n`).update(readFileSync(join(dist, file)));
  }
  return hash.digest('hex');
}

/** Null where `folder` is not the root of a working copy. */
function commitOf(folder) {
  const git = (...args) =>
    execFileSync('git', args, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] }).trim();
  try {
    // A copy of dist may lie inside another working copy, whose commit says nothing.
    if (realpathSync(git('rev-parse', '--show-toplevel')) !== folder) return null;
    const isChanged = git('status', '--porcelain', '--untracked-files=no') !== '';
    return `${git('rev-parse', '--short=12', 'HEAD')}${isChanged ? '+changes' : ''}`;
  } catch {
    return null;
  }
}
