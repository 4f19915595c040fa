import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { type CallExpression, parseSync, Visitor } from 'oxc-parser';
import { expect, test } from 'vitest';
import { repositoryFiles } from './repository-files.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));

/** Code of packages and apps, but not of their tests. */
const CODE = /^(?:packages|apps)\/(?!.*(?:\.test|[.-]fixture|\/testing\/))[^/]+\/src\/.*\.tsx?$/;
/** Code that handles what is in files, where no list at all becomes arguments. */
const READS_FILES = /^packages\/core\/src\/io\//;
/** Functions that take lists of any length: others have as many parameters as their callers need. */
const COLLECTORS = /(?:^Math\.(?:max|min)|\.(?:push|unshift|splice|concat|of|fromCharCode))$/;

/** Lists that are short whatever is drawn or read, by what they hold; and the files and folders with calls that take them. */
const SHORT_LISTS: Readonly<Record<string, readonly string[]>> = {
  'numbers of a vector, a matrix, a colour or a box': [
    'apps/examples/src/routes/bones.tsx',
    'apps/viewer/src/camera/',
    'apps/viewer/src/inspect/cropping.ts',
    'apps/viewer/src/navigate/',
    'apps/viewer/src/scene/scene-answers.ts',
    'apps/viewer/src/share/scene-settings.ts',
    'packages/core/src/features/motion/pack-motion.data.ts',
    'packages/core/src/features/skin/skin.clouds.ts',
    'packages/core/src/clouds/collider/',
    'packages/core/src/data/camera/',
    'packages/core/src/data/math/',
    'packages/core/src/data/packing/',
    'packages/core/src/framing/',
    'packages/core/src/gpu/effects/relight/',
    'packages/core/src/gpu/effects/volumes/volume-frame.ts',
    'packages/core/src/gpu/effects/volumes/volumes.reference.ts',
    'packages/core/src/inspect/compare-records.ts',
    'packages/core/src/inspect/error-bounds.ts',
    'packages/core/src/reference/merged-splat.ts',
    'packages/react/src/fit-camera.ts',
    'packages/three/src/own-data/bind-skeleton.ts',
  ],
  'parts of an array of a fixed length': [
    'apps/lab/src/peers/page/canvas-picture.ts',
    'apps/viewer/src/path/gltf-path.ts',
    'apps/viewer/src/share/page-text.ts',
    'apps/viewer/src/inspect/histogram-tab.tsx',
    'packages/core/src/stages/',
  ],
  'at most as many as a constant allows: volumes, frames that are remembered, children of a cell': [
    'packages/core/src/clouds/bricks/brick-plan.ts',
    'packages/core/src/gpu/effects/volumes/volume-grid.ts',
    'packages/core/src/views/',
    'apps/viewer/src/ui/',
  ],
  'a few, written out in code: buffers of a cloud, states of a morph, limits, hooks of effects': [
    'packages/core/src/features/gpu-splats/gpu-splats.clouds.ts',
    'packages/core/src/features/morph/splat-morph.data.ts',
    'packages/core/src/frame/plan/level-cut.ts',
    'packages/core/src/gpu/effects/cloud-effects.ts',
    'packages/core/src/gpu/effects/effect-set.ts',
    'packages/three/src/scene/scene-effects.ts',
  ],
  'accuracies that are measured or compared': [
    'apps/viewer/src/accuracy/',
    'apps/viewer/src/state/accuracy.ts',
    'packages/charts/',
    'packages/core/src/data/accuracy/',
    'packages/core/src/measure/',
  ],
  'pages of GPU memory': [
    'packages/core/src/clouds/ingest/',
    'packages/core/src/frame/parts/selection-bits.ts',
  ],
  'clouds or scenes that are open together, clipping planes': [
    'apps/lab/src/benchmark/',
    'apps/viewer/src/engine/',
    'packages/three/src/scene/clipping-groups.ts',
  ],
  'rows of a printed table, names of drivers': [
    'apps/lab/src/conformance/',
    'apps/lab/src/peers/frames/',
    'apps/lab/src/peers/runner/',
    'packages/cli/src/hardcases.ts',
    'packages/cli/src/info.ts',
    'packages/conformance/',
    'packages/node/src/',
  ],
};

/** Lists that a module passes as arguments, as `line: text`. One that is written out at its call is as long as it is there. */
function spreadCalls(path: string, text: string, calls = /^/): string[] {
  // Modules that spread only into lists and objects need not be parsed.
  if (!/(?<![[{]\s*)\.\.\./.test(text)) return [];
  const found: string[] = [];
  const check = ({ callee, arguments: given }: Pick<CallExpression, 'arguments' | 'callee'>) => {
    if (!calls.test(text.slice(callee.start, callee.end))) return;
    for (const each of given) {
      if (each.type !== 'SpreadElement' || each.argument.type === 'ArrayExpression') continue;
      found.push(`${text.slice(0, each.start).split('\n').length}: ${text.slice(each.start, each.end)}`);
    }
  };
  new Visitor({ CallExpression: check, NewExpression: check }).visit(parseSync(path, text).program);
  return found;
}

const callsIn = (path: string) =>
  spreadCalls(path, readFileSync(join(root, path), 'utf8'), READS_FILES.test(path) ? /^/ : COLLECTORS);
const paths = repositoryFiles(root).filter((path) => CODE.test(path));

/**
 * @fault Files: a file, a text or an argument holds a list of any length
 * @consequence no code passes a list as the arguments of a call, which overflows the stack
 */
test('no list of any length becomes the arguments of a call, which overflow the stack', () => {
  expect(paths.length).toBeGreaterThan(700);
  const isShort = (path: string) =>
    Object.values(SHORT_LISTS).some((places) => places.some((place) => path.startsWith(place)));
  const found = paths
    .filter((path) => !isShort(path))
    .flatMap((path) => callsIn(path).map((call) => `${path}:${call}`));
  expect(found).toEqual([]);
});

test('each exception has such a list', () => {
  for (const place of Object.values(SHORT_LISTS).flat())
    expect(
      paths.some((path) => path.startsWith(place) && callsIn(path).length > 0),
      place,
    ).toBe(true);
});

test('the rule on lists as arguments finds them in calls and constructors, and no others', () => {
  const text = 'f(...a);\nnew B(1, ...c.d());\ng(...[1, 2]);\nh([...a], { ...b });\nMath.max(...e, 1);';
  expect(spreadCalls('a.ts', text)).toEqual(['1: ...a', '2: ...c.d()', '5: ...e']);
  expect(spreadCalls('a.ts', text, COLLECTORS)).toEqual(['5: ...e']);
});
