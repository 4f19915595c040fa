import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { describe, expect, test } from 'vitest';
import { type ImportRule, importViolations } from './import-rule.ts';
import { moduleReferences } from './module-references.ts';
import { repositoryFiles } from './repository-files.ts';
import { lonelyModules, type Module } from './room-rule.ts';
import { CORE_TIERS, PACKAGES, PATH_EXCEPTIONS, TIERS } from './tiers.ts';

const RULE: ImportRule = {
  packages: PACKAGES,
  tiers: TIERS,
  pathExceptions: PATH_EXCEPTIONS,
};

const root = fileURLToPath(new URL('../../..', import.meta.url));
const modules = new Map(repositoryFiles(root).filter(isModule).map(readModule));
const files = new Map([...modules].map(([path, { references }]) => [path, references]));
const violations = importViolations(files, RULE);

function isModule(path: string): boolean {
  return /^(?:apps|e2e|packages|shaders)\/.*\.(?:tsx?|m?js|wgsl)$/.test(path);
}

function readModule(path: string): [path: string, module: Module] {
  if (path.endsWith('.wgsl')) return [path, { lines: 0, references: [] }];
  return [path, moduleOf(path, readFileSync(join(root, path), 'utf8'))];
}

function moduleOf(path: string, text: string): Module {
  return { lines: text.split('\n').length - 1, references: moduleReferences(path, text) };
}

/** Violations that adding these texts to these files causes. */
function newViolations(texts: Readonly<Record<string, string>>, rule = RULE): string[] {
  const planted = new Map(files);
  for (const [path, text] of Object.entries(texts))
    planted.set(path, [...(files.get(path) ?? []), ...moduleReferences(path, text)]);
  return importViolations(planted, rule).filter((violation) => !violations.includes(violation));
}

describe('the import rule', () => {
  test('holds in this repository', () => {
    expect(violations).toEqual([]);
  });

  test('allows packages what their package.json says, and tests what its devDependencies say', () => {
    for (const [name, line] of Object.entries(PACKAGES)) {
      const candidates = ['.', 'apps', 'packages'].map((each) => join(root, each, name, 'package.json'));
      const path = candidates.find((each) => existsSync(each));
      const { dependencies = {}, devDependencies = {} } = JSON.parse(readFileSync(path!, 'utf8'));
      const own = (of: object) =>
        Object.keys(of).flatMap((each) => /^@websplatter\/(.*)$/.exec(each)?.[1] ?? []);
      const expected = [...own(dependencies), ...own(devDependencies).map((each) => `${each}(tests)`)];
      // The shaders have no exports: they are read by path.
      const arrows = line.split(' ').filter((arrow) => arrow && !arrow.startsWith('shaders'));
      expect(arrows.sort(), name).toEqual(expected.sort());
    }
  });
});

describe('planted in this repository, the import rule finds', () => {
  const math = 'packages/core/src/data/math/mat4.ts';

  test('an upward import, however it is written', () => {
    const statements = [
      "import { recordFrame } from '../../frame/frame.ts';",
      "import type { Frame } from '../../frame/frame.ts';",
      "import { type Frame } from '../../frame/frame.ts';",
      "import '../../frame/frame.ts';",
      "export * from '../../frame/frame.ts';",
      "export type { Frame } from '../../frame/frame.ts';",
      "const lazy = () => import('../../frame/frame.ts');",
      "let frame: import('../../frame/frame.ts').Frame;",
      "new Worker(new URL('../../frame/frame.ts', import.meta.url));",
      "import text from '../../frame/frame.ts?raw';",
      "vi.doMock('../../frame/frame.ts', () => ({}));",
    ];
    const planted = statements.map((statement, i) => [
      `packages/core/src/data/math/planted-${i}.ts`,
      statement,
    ]);
    const found = newViolations(Object.fromEntries(planted));
    for (const [path, statement] of planted)
      expect(found, statement).toContain(
        `${path} → packages/core/src/frame/frame.ts: data may not import frame`,
      );
  });

  test('an upward glob', () => {
    expect(newViolations({ [math]: "import.meta.glob('../../frame/*.ts');" })).toEqual([
      `${math} → packages/core/src/frame/*.ts: data may not import frame`,
    ]);
  });

  test('a reference beside the code that it is the reference of', () => {
    const [effect, reference] = ['ts', 'reference.ts'].map(
      (end) => `packages/core/src/gpu/effects/fog/fog.${end}`,
    );
    expect(newViolations({ [effect]: "import type { reference } from './fog.reference.ts';" })).toContain(
      `${effect} → ${reference}: gpu may not import reference`,
    );
    expect(newViolations({ [effect]: "import.meta.glob('./*.reference.ts');" })).toEqual([
      `${effect} → packages/core/src/gpu/effects/fog/*.reference.ts: gpu may not import reference`,
    ]);
  });

  test('nothing in comments and texts that look like imports', () => {
    const text =
      '// import { frame } from "../../frame/frame.ts";\nconst text = `import "../../frame/frame.ts"`;';
    expect(newViolations({ [math]: text })).toEqual([]);
  });

  test('a circle of types between files of one tier', () => {
    const [one, two] = ['one', 'two'].map((name) => `packages/core/src/data/math/${name}.ts`);
    const toTwo = "import type { Two } from './two.ts';";
    expect(newViolations({ [one]: toTwo, [two]: '' })).toEqual([]);
    expect(newViolations({ [one]: toTwo, [two]: "import type { One } from './one.ts';" })).toEqual([
      `${one} → ${two} → ${one}: a circle`,
    ]);
  });

  test('a value where only types are allowed', () => {
    const view = 'packages/core/src/views/splat-view.ts';
    expect(
      newViolations({ [view]: "import { chooseAccuracy } from '../measure/choose-accuracy.ts';" }),
    ).toEqual([
      `${view} → packages/core/src/measure/choose-accuracy.ts: views may not import measure but for its types`,
    ]);
  });

  test('helpers of tests in shipped files', () => {
    expect(newViolations({ [math]: "import { uniform } from '../../testing/uniform.ts';" })).toContain(
      `${math} → packages/core/src/testing/uniform.ts: only tests may import what is for tests`,
    );
  });

  test('a package above, by name', () => {
    expect(newViolations({ [math]: "import { Splats } from '@websplatter/three';" })).toEqual([
      `${math} → @websplatter/three: core may not import three`,
    ]);
  });

  test('a package that only tests may import', () => {
    expect(newViolations({ [math]: "import { clusters } from '@websplatter/scenes';" })).toEqual([
      `${math} → @websplatter/scenes: core may not import scenes but in its tests`,
    ]);
  });

  test('a file of another package, by path', () => {
    const path = 'packages/three/src/index.ts';
    expect(
      newViolations({ [path]: "import { multiply4 } from '../../core/src/data/math/mat4.ts';" }),
    ).toEqual([`${path} → packages/core/src/data/math/mat4.ts: import it from @websplatter/core`]);
  });

  test('a folder and a package that have no line', () => {
    expect(newViolations({ 'packages/core/src/attic/old.ts': '' })).toEqual([
      'attic: this tier has no line that says what it may import',
    ]);
    expect(newViolations({ 'packages/attic/src/old.ts': '' })).toEqual([
      'attic: this package has no line that says what it may import',
    ]);
  });

  test('a line, an arrow and an exception that nothing needs', () => {
    const tiers = {
      ...TIERS,
      'packages/core/src/': { ...CORE_TIERS, data: '', attic: '', gpu: `io ${CORE_TIERS.gpu}` },
    };
    const pathExceptions = { ...PATH_EXCEPTIONS, [math]: 'for a test' };
    expect(newViolations({ [math]: '' }, { ...RULE, tiers, pathExceptions })).toEqual([
      'attic: has a line, but there is no such tier',
      'gpu → io: allowed, but nothing needs it',
      `${math}: an exception that is no longer needed`,
    ]);
  });

  test('an arrow that points at a tier below it in the table', () => {
    expect(
      newViolations(
        { [math]: '' },
        { ...RULE, tiers: { ...TIERS, 'packages/core/src/': { ...CORE_TIERS, data: 'frame' } } },
      ),
    ).toContain('data → frame: a tier may only import those above it in the table');
  });
});

/** Small modules with one reader that stay files, and why. */
const EXCEPTIONS: Readonly<Record<string, string>> = {
  'apps/lab/src/conformance/run-words.ts':
    'its test cannot import its reader, which needs the facts of a build',
  'apps/lab/src/peers/levels/options.ts': 'its test cannot import its reader, which needs packages of peers',
  'packages/core/src/stages/cover/cover.ts': 'a family of stages has its hosts in its folder',
  'packages/core/src/stages/pick/pick.ts': 'a family of stages has its hosts in its folder',
};

test('small modules live with their only reader', () => {
  const inRooms = [...modules].filter(([path]) => /^(?:apps|packages)\/.*(?<!\.d)\.tsx?$/.test(path));
  expect(inRooms.length).toBeGreaterThan(500);
  expect(lonelyModules(new Map(inRooms), EXCEPTIONS)).toEqual([]);
});

describe('planted, the rule on small modules finds', () => {
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
