import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { describe, expect, test } from 'vitest';
import { repositoryFiles } from './repository-files.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));
/** Put together, since this file names nothing outside, either. */
const SHARED = ['..', 'shared'].join('/');

/** Paths in `text` that climb out of the repository from `path`, or name a shared folder. */
function pathsOutside(path: string, text: string): string[] {
  const depth = path.split('/').length - 1;
  const climbs = text.match(/(?<![\w./-])(?:\.\/)?\.\.(?:\/\.\.)*(?![\w.])[^\s'"`)]*/g) ?? [];
  // Reversed slashes, in tests of hostile names, climb nowhere.
  const stepsOf = (climb: string) => climb.match(/\.\.(?=\/|$)/g)?.length ?? 0;
  return climbs.filter((climb) => climb.includes(SHARED) || stepsOf(climb) > depth);
}

test('no file of the repository names a path outside of it', () => {
  const listed = repositoryFiles(root);
  const found = listed.flatMap((path) => {
    const text = readFileSync(join(root, path), 'latin1');
    const isBinary = text.includes('\0');
    return isBinary ? [] : pathsOutside(path, text).map((climb) => `${path}: ${climb}`);
  });
  expect(listed).toContain('packages/tools/src/tiers.ts');
  expect(found).toEqual([]);
});

describe('planted in a file, it finds', () => {
  const climb = (steps: number) => Array(steps).fill('..').join('/');

  test.each([
    ['e2e/viewer.test.ts', `new URL('${climb(2)}/scenes/', import.meta.url)`],
    ['packages/core/src/io/a.ts', `resolve(import.meta.dirname, '${climb(5)}')`],
    ['packages/core/src/io/a.ts', `import text from "./${climb(5)}/a.ts?raw";`],
    ['docs/a.md', `See [the scenes](${climb(2)}/scenes).`],
    ['README.md', `The folder \`${climb(1)}/scenes\` has them.`],
    ['packages/core/src/a.ts', `join(folder, '${SHARED}/a.ply')`],
    ['packages/core/src/a.ts', `skip('${SHARED} is not here')`],
  ])('a path out of the repository: %s, %s', (path, text) => {
    expect(pathsOutside(path, text)).toHaveLength(1);
  });

  test.each([
    ['e2e/viewer.test.ts', `new URL('${climb(1)}/packages/', import.meta.url)`],
    ['packages/tools/src/a.ts', `new URL('${climb(3)}', import.meta.url)`],
    ['README.md', 'From a..b on, [...values] and so on...'],
    ['a.ts', 'const { a, ...rest } = b;'],
  ])('nothing else: %s, %s', (path, text) => {
    expect(pathsOutside(path, text)).toEqual([]);
  });
});
