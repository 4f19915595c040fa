import { lstatSync, readdirSync } from 'node:fs';
import { join, posix } from 'node:path';

/**
 * Lists third-party packages that this repository's packages and apps need at run time: their
 * `dependencies` and `peerDependencies`.
 *
 * @param {Record<string, object>} locks each package-lock.json, by its folder.
 * @returns {Map<string, string[]>} by dependency, the sorted folders that need it.
 */
export function thirdParties(locks) {
  const needed = new Map();
  for (const [project, lock] of Object.entries(locks)) {
    for (const [folder, { dependencies, peerDependencies }] of Object.entries(lock.packages)) {
      if (folder.includes('node_modules') || folder.startsWith('..')) continue;
      for (const name of Object.keys({ ...dependencies, ...peerDependencies })) {
        if (name.startsWith('@websplatter/')) continue;
        needed.set(name, [...(needed.get(name) ?? []), posix.join(project, folder)].sort());
      }
    }
  }
  return needed;
}

/**
 * Bytes of a dependency and of all its own dependencies in node_modules.
 *
 * @param {object} lock package-lock.json of the folder `root`, where it is installed.
 */
export function installedBytes(lock, root, name) {
  const counted = new Set();
  const add = (path) => {
    if (path === undefined || counted.has(path)) return;
    counted.add(path);
    for (const each of Object.keys(lock.packages[path].dependencies ?? {})) add(locked(lock, path, each));
  };
  add(locked(lock, '', name));
  return [...counted].reduce((sum, path) => sum + folderBytes(join(root, path)), 0);
}

/**
 * Where npm installed the `name` that `from` resolves; undefined for none or for a link elsewhere.
 */
function locked(lock, from, name) {
  for (let at = from; ; at = at.slice(0, Math.max(0, at.lastIndexOf('/node_modules/')))) {
    const path = `${at === '' ? '' : `${at}/`}node_modules/${name}`;
    if (lock.packages[path]) return lock.packages[path].link ? undefined : path;
    if (at === '') return undefined;
  }
}

function folderBytes(folder) {
  let bytes = 0;
  for (const entry of readdirSync(folder, { withFileTypes: true })) {
    const path = join(folder, entry.name);
    if (!entry.isDirectory()) bytes += lstatSync(path).size;
    // Nested node_modules are packages of their own.
    else if (entry.name !== 'node_modules') bytes += folderBytes(path);
  }
  return bytes;
}
