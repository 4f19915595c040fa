import { expect, test } from 'vitest';
import { manifestProblems, missingExports } from './manifests.mjs';

const ROOT = { license: 'MIT', engines: { node: '>=20' } };
const CORE = {
  name: '@ours/core',
  version: '1.0.0',
  description: 'splats',
  keywords: ['splats'],
  license: 'MIT',
  engines: { node: '>=20' },
  files: ['dist'],
  type: 'module',
  sideEffects: false,
  publishConfig: { access: 'public', provenance: true },
};
const THREE = { ...CORE, name: '@ours/three', dependencies: { '@ours/core': '1.0.0' } };

function problems(changes, root = ROOT) {
  const manifests = { 'packages/core': CORE, 'packages/three': THREE, 'apps/viewer': { private: true } };
  return manifestProblems(root, { ...manifests, ...changes }, ['packages/core', 'packages/three']);
}

test('manifests that agree pass', () => {
  expect(problems({})).toEqual([]);
});

/**
 * @fault Pages and packages: a manifest that is incomplete, or contradicts another
 * @consequence `npm run check` fails with the field
 */
test.each([
  [{ 'packages/core': { ...CORE, keywords: undefined } }, '"keywords" is missing'],
  [{ 'packages/core': { ...CORE, license: 'ISC' } }, '"license" is not the repository'],
  [{ 'packages/core': { ...CORE, private: true } }, 'it cannot be private'],
  [{ 'packages/core': { ...CORE, publishConfig: { access: 'public' } } }, '"publishConfig" must be'],
  [{ 'packages/core': { ...CORE, repository: { url: 'x' } } }, '"repository" must be missing'],
  [{ 'packages/core': { ...CORE, homepage: 'x' } }, '"homepage" is not the repository'],
  [{ 'packages/core': { ...CORE, version: '1.1.0' } }, 'must depend on @ours/core 1.1.0, not 1.0.0'],
  [{ 'packages/core': { ...CORE, version: '1.1.0' } }, 'several versions: 1.1.0, 1.0.0'],
  [
    { 'packages/core': { ...CORE, dependencies: { left: '1.0.0' } } },
    'depends on left, which is not published',
  ],
  [{ 'apps/viewer': {} }, '"private" must be true'],
])('%j: %s', (changes, problem) => {
  expect(problems(changes).join('\n')).toContain(problem);
});

test('each package names its folder in the repository that the root names', () => {
  const repository = { type: 'git', url: 'git+https://host.example/ours.git' };
  expect(problems({}, { ...ROOT, repository })).toHaveLength(2);
  const placed = (manifest, directory) => ({ ...manifest, repository: { ...repository, directory } });
  const changes = {
    'packages/core': placed(CORE, 'packages/core'),
    'packages/three': placed(THREE, 'packages/three'),
  };
  expect(problems(changes, { ...ROOT, repository })).toEqual([]);
});

/**
 * @fault Pages and packages: `exports` name a file that is not packed
 * @consequence `npm run check` fails with the file
 */
test('exports name packed files only', () => {
  const exports = { '.': { source: './src/index.ts', default: './dist/index.js' }, './files/*': './files/*' };
  expect(missingExports({ ...CORE, exports }, new Set(['dist/index.js']))).toEqual([
    '@ours/core: exports name ./src/index.ts, which is not packed',
  ]);
});
