import { expect, test } from 'vitest';
import { importersOf, nearestTests } from './nearest-tests.mjs';

const nearest = (path, texts) => nearestTests(path, importersOf(new Map(Object.entries(texts))));

test('tests that import a module come before those that do so through others', () => {
  const texts = {
    'packages/core/src/a.ts': '',
    'packages/core/src/b.ts': "import { a } from './a.ts';",
    'packages/core/src/b.test.ts': "import { b } from './b.ts';",
    'packages/core/src/a.test.ts': "import { a } from './a.ts';",
    'packages/core/src/a.long.test.ts': "import { a } from './a.ts';",
    'packages/core/src/types.test.ts': "import type { A } from './a.ts';",
    'packages/core/src/index.ts': "export * from './b.ts';",
    'packages/three/src/c.test.ts': "import { b } from '@websplatter/core';",
  };
  expect(nearest('packages/core/src/a.ts', texts)).toEqual([
    'packages/core/src/a.test.ts',
    'packages/core/src/b.test.ts',
    'packages/three/src/c.test.ts',
  ]);
});

test('globs, names with parts that vary, and queries are imports', () => {
  const texts = {
    'packages/core/src/formats/ply/read-ply.ts': '',
    'packages/core/src/formats.ts': "import.meta.glob('./formats/*/read-{ply,spz}.ts')",
    'packages/core/src/read.ts': 'import(`./formats/$NAME/read-$NAME.ts`)'.replaceAll('NAME', '{name}'),
    'packages/core/src/formats.test.ts': "import { formats } from './formats.ts';",
    'packages/core/src/read.test.ts': "import { read } from './read.ts?worker';",
    'packages/core/src/other.test.ts': "import.meta.glob('./formats/*/read-sog.ts')",
  };
  expect(nearest('packages/core/src/formats/ply/read-ply.ts', texts)).toEqual([
    'packages/core/src/formats.test.ts',
    'packages/core/src/read.test.ts',
  ]);
});

test('shaders are reached by their own tests, by modules beside them, and by shaders that import them', () => {
  const texts = {
    'shaders/lib/two-sum.wgsl': '',
    'packages/core/src/stages/cull/cull-splats.wgsl': 'import package::lib::two_sum::twoSum;',
    'packages/core/src/stages/cull/cull-splats.gpu.test.ts': '',
    'packages/core/src/stages/cull/other.gpu.test.ts': '',
    'packages/core/src/stages/cull/cull.ts': '',
    'packages/core/src/frame.test.ts': "import { cull } from './stages/cull/cull.ts';",
  };
  expect(nearest('shaders/lib/two-sum.wgsl', texts)).toEqual([
    'packages/core/src/stages/cull/cull-splats.gpu.test.ts',
    'packages/core/src/frame.test.ts',
  ]);
});
