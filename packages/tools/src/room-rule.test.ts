import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { describe, expect, test } from 'vitest';
import { moduleReferences } from './module-references.ts';
import { repositoryFiles } from './repository-files.ts';
import { lonelyModules, type Module } from './room-rule.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));

/** Small modules with one reader that stay files, and why. */
const EXCEPTIONS: Readonly<Record<string, string>> = {
  'apps/lab/src/conformance/run-words.ts':
    'its test cannot import its reader, which needs the facts of a build',
  'apps/lab/src/peers/levels/options.ts': 'its test cannot import its reader, which needs packages of peers',
  'packages/core/src/stages/cover/cover.ts': 'a family of stages has its hosts in its folder',
  'packages/core/src/stages/morph/morph.ts': 'a family of stages has its hosts in its folder',
  'packages/core/src/stages/pick/pick.ts': 'a family of stages has its hosts in its folder',
};

function moduleOf(path: string, text: string): Module {
  return { lines: text.split('\n').length - 1, references: moduleReferences(path, text) };
}

test('small modules live with their only reader', () => {
  const paths = repositoryFiles(root).filter((path) => /^(?:apps|packages)\/.*(?<!\.d)\.tsx?$/.test(path));
  const modules = new Map(
    paths.map((path) => [path, moduleOf(path, readFileSync(join(root, path), 'utf8'))]),
  );
  expect(modules.size).toBeGreaterThan(500);
  expect(lonelyModules(modules, EXCEPTIONS)).toEqual([]);
});

describe('planted, the rule finds', () => {
  const SMALL = 'export const a = 1;\n';
  const READER = "import { a } from './a.ts';\n";
  const found = (files: Readonly<Record<string, string>>, exceptions = {}) =>
    lonelyModules(
      new Map(
        Object.entries(files).map(([path, text]) => [`packages/core/src/${path}`, moduleOf(path, text)]),
      ),
      exceptions,
    );

  test('a small module with one reader', () => {
    expect(found({ 'a.ts': SMALL, 'b.ts': READER })).toEqual([
      'packages/core/src/a.ts: 1 lines with one reader, packages/core/src/b.ts',
    ]);
  });

  test.each([
    ['two readers', { 'a.ts': SMALL, 'b.ts': READER, 'c.ts': READER }],
    ['a reader that loads it later', { 'a.ts': SMALL, 'b.ts': "const load = () => import('./a.ts');\n" }],
    ['a worker', { 'a.ts': SMALL, 'b.ts': "new Worker(new URL('./a.ts', import.meta.url));\n" }],
    ['a reader of its export', { 'a.ts': SMALL, 'b.ts': `${READER}import '@websplatter/core/a';\n` }],
    ['more lines', { 'a.ts': SMALL.repeat(61).replaceAll(/export const a/g, 'var a'), 'b.ts': READER }],
    ['a long reader', { 'a.ts': SMALL, 'b.ts': READER + '\n'.repeat(450) }],
    ['a tier of its own', { 'a.reference.ts': SMALL, 'b.ts': "import { a } from './a.reference.ts';\n" }],
    ['a reader that is a test', { 'a.ts': SMALL, 'b.test.ts': READER }],
  ])('nothing about a module with %s', (_, files) => {
    expect(found(files as Record<string, string>)).toEqual([]);
  });

  test('an exception that is no longer needed', () => {
    expect(found({ 'a.ts': SMALL }, { 'packages/core/src/a.ts': 'for a test' })).toEqual([
      'packages/core/src/a.ts: an exception that is no longer needed',
    ]);
  });
});
