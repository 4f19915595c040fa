import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';

/**
 * Bytes of a built page's scripts, each compressed by gzip as web servers do. Workers are not among
 * them: they are built apart.
 *
 * @param {string} folder Vite's output, with its manifest.
 * @param {readonly string[]} first names of scripts that the page fetches at once, although it
 * imports them dynamically.
 * @param {readonly string[]} apart modules, as the manifest names them, whose dynamic imports are
 * not followed.
 * @returns {{ initial: number, all: number }} of what `index.html` names and of `first`, static
 * imports included, and with all that these
 *   may fetch later.
 */
export function scriptSizes(folder, first, apart) {
  const manifest = JSON.parse(readFileSync(join(folder, '.vite/manifest.json'), 'utf8'));
  const keyOf = (name) => Object.keys(manifest).find((key) => manifest[key].name === name);
  const firstKeys = first.map(keyOf);
  const missing = [...apart.filter((key) => !manifest[key]), ...first.filter((name) => !keyOf(name))];
  if (missing.length > 0) throw new Error(`There is no script of its own for ${missing.join(', ')}.`);
  const bytesOf = (keys) =>
    [...keys].reduce((sum, key) => sum + gzipSync(readFileSync(join(folder, manifest[key].file))).length, 0);
  const all = reached(manifest, ({ imports = [], dynamicImports = [] }) => [
    ...imports,
    ...dynamicImports.filter((key) => !apart.includes(key)),
  ]);
  const initial = reached(manifest, ({ imports = [], dynamicImports = [] }) => [
    ...imports,
    ...dynamicImports.filter((key) => firstKeys.includes(key)),
  ]);
  return { initial: bytesOf(initial), all: bytesOf(all) };
}

/** Keys of the manifest that are reached from the page by `next`. */
function reached(manifest, next) {
  const keys = new Set(['index.html']);
  // A set goes on to those that are added meanwhile.
  for (const key of keys) for (const each of next(manifest[key])) keys.add(each);
  return keys;
}
