import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';

/**
 * Gzip sizes of a built page's scripts, each compressed separately as web servers do. Workers are
 * not included: they are built separately.
 *
 * @param {string} folder Vite's output, with its manifest.
 * @param {readonly string[]} first names of scripts that the page fetches at once, although it
 * imports them dynamically.
 * @param {readonly string[]} apart modules, as named in the manifest, whose dynamic imports are not
 * followed.
 * @returns {{ initial: number, all: number }} bytes. `initial`: scripts of `index.html`, `first`,
 * and their static imports; `all`: also scripts that these may fetch later.
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

/** Scripts of a built page that import themselves by way of others: one of them begins without the other's values. */
export function scriptCircles(folder) {
  const manifest = JSON.parse(readFileSync(join(folder, '.vite/manifest.json'), 'utf8'));
  const importsOf = ({ imports = [] }) => imports;
  return Object.keys(manifest)
    .filter((key) => reached(manifest, importsOf, importsOf(manifest[key])).has(key))
    .map((key) => manifest[key].file);
}

/** Keys of the manifest that are reached from `first` by following `next`. */
function reached(manifest, next, first = ['index.html']) {
  const keys = new Set(first);
  // Iterating a Set also visits keys that are added meanwhile.
  for (const key of keys) for (const each of next(manifest[key])) keys.add(each);
  return keys;
}
