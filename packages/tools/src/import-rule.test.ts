import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { describe, expect, test } from 'vitest';
import { type ImportRule, importViolations, type RepositoryFiles } from './import-rule.ts';
import { type ModuleReference, moduleReferences } from './module-references.ts';
import { repositoryFiles } from './repository-files.ts';
import { CORE_TIERS, PACKAGES, PATH_EXCEPTIONS, TIERS } from './tiers.ts';

const RULE: ImportRule = {
  packages: PACKAGES,
  tiers: TIERS,
  pathExceptions: PATH_EXCEPTIONS,
};

const root = fileURLToPath(new URL('../../..', import.meta.url));
const files: RepositoryFiles = new Map(repositoryFiles(root).flatMap(referencesOf));
const violations = importViolations(files, RULE);

function referencesOf(path: string): [path: string, references: ModuleReference[]][] {
  if (!/^(?:apps|e2e|packages|shaders)\//.test(path)) return [];
  if (path.endsWith('.wgsl')) return [[path, []]];
  return /\.(?:tsx?|m?js)$/.test(path)
    ? [[path, moduleReferences(path, readFileSync(join(root, path), 'utf8'))]]
    : [];
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
  const upward = `${math} → packages/core/src/frame/frame.ts: data may not import frame`;

  for (const statement of [
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
  ])
    test(`an upward import: ${statement}`, () => {
      expect(newViolations({ [math]: statement })).toContain(upward);
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
