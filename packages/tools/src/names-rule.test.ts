// Proves: a name of a type has one meaning within a package, and the glossary's types exist.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { repositoryFiles } from './repository-files.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));
const PRODUCTS = ['packages/core/', 'packages/three/', 'packages/react/', 'apps/viewer/'];
/**
 * Both are public. A class and the type of what it makes have one name in the interface; rotations of volumes are
 * quaternions as three.js writes them, those of splats as files do.
 */
const TWINS = ['packages/core/ SplatEngine', 'packages/core/ Quaternion'];

const declared = namesByPackage(
  repositoryFiles(root)
    .filter((path) => /\.tsx?$/.test(path) && !/\.(?:test|fixture|d)\.tsx?$|\/testing\//.test(path))
    .map((path) => ({ path, text: readFileSync(join(root, path), 'utf8') })),
);

/** Files that export a type or a class, by package and name. */
function namesByPackage(files: readonly { readonly path: string; readonly text: string }[]) {
  const found = new Map<string, string[]>();
  for (const { path, text } of files) {
    const product = PRODUCTS.find((folder) => path.startsWith(folder));
    if (!product) continue;
    for (const [, name] of text.matchAll(/^export (?:abstract )?(?:interface|class|type) ([A-Z]\w*)/gm))
      found.set(`${product} ${name}`, [...(found.get(`${product} ${name}`) ?? []), path]);
  }
  return found;
}

function twins(names: ReturnType<typeof namesByPackage>): string[] {
  return [...names].flatMap(([name, files]) => (new Set(files).size > 1 ? name : []));
}

test('no two files of a package export types of one name', () => {
  expect(twins(declared).sort()).toEqual(TWINS.toSorted());
});

test('two types of one name are found, in one package alone', () => {
  const text = 'export interface Frame {}\nexport type Frame = 1;\nconst Frame = 2;';
  const at = (...paths: string[]) => twins(namesByPackage(paths.map((path) => ({ path, text }))));
  expect(at('packages/core/a.ts', 'packages/core/b.ts')).toEqual(['packages/core/ Frame']);
  expect(at('packages/core/a.ts', 'packages/three/b.ts', 'apps/lab/c.ts', 'apps/lab/d.ts')).toEqual([]);
});

test('types that the glossary names exist', () => {
  const glossary = readFileSync(join(root, 'docs/glossary.md'), 'utf8');
  const named = [...glossary.matchAll(/`([A-Z]\w*[a-z]\w*)`/g)].map(([, name]) => name);
  const known = new Set([...declared.keys()].map((key) => key.split(' ')[1]));
  expect(named.length).toBeGreaterThan(10);
  expect(named.filter((name) => !known.has(name))).toEqual([]);
});
