import { describe, expect, test } from 'vitest';

const shaders = basenames(import.meta.glob('../../../../../shaders/stages/*.wgsl'));
const hosts = basenames(import.meta.glob(['./*.ts', '!./*.test.ts']));
const gpuTests = basenames(import.meta.glob('./*.gpu.test.ts'));
const references = basenames(import.meta.glob(['../../reference/*.ts', '!../../reference/*.test.ts']));
const libraries = basenames(import.meta.glob('../../../../../shaders/lib/*.wgsl'));

function basenames(files: Readonly<Record<string, unknown>>): ReadonlySet<string> {
  return new Set(Object.keys(files).map((path) => /([^/.]+)[^/]*$/.exec(path)![1]));
}

/** Exceptions, with reasons, to a stage's shader, host, reference and GPU test of one basename. */
const EXCEPTIONS: Readonly<Record<string, string>> = {
  'stages/dispatch.ts': 'is the host’s reference of shaders/lib/dispatch.wgsl, which all stages share',
  'stages/radix-sort.ts':
    'combines the stages of the sort: plan-sort, the three stages of every pass, and sort-gather',
  'stages/radix-sort.gpu.test.ts': 'compares the combined stages of the sort with a sort on the CPU',
  'reference/radix-sort.ts': 'combines the references of the stages of the sort',
  'stages/packing-libraries.ts': 'is shared by the stages that pack splats',
  'stages/format-conditions.ts': 'is shared by the stages that write or read records and layers',
  'stages/tile-lists.gpu.test.ts': 'checks the combined stages that list bins and tiles for any splat',
  'stages/sort-shape.ts': 'is shared by the stages of the sort',
  'reference/index.ts': 'is the entry point @websplatter/core/reference',
  'reference/render.ts': 'combines the references into the reference renderer',
  'reference/trace-splat.ts': 'combines the references for one splat',
};

interface Folders {
  readonly shaders: ReadonlySet<string>;
  readonly hosts: ReadonlySet<string>;
  readonly gpuTests: ReadonlySet<string>;
  readonly references: ReadonlySet<string>;
}

/** Lists missing files of stages, files that belong to no stage, and unused exceptions. */
function flaws(
  { shaders, hosts, gpuTests, references }: Folders,
  exceptions: Readonly<Record<string, string>>,
) {
  const kinds = [
    [hosts, (name: string) => `stages/${name}.ts`, shaders],
    [gpuTests, (name: string) => `stages/${name}.gpu.test.ts`, shaders],
    // Functions that several shaders share also have references.
    [references, (name: string) => `reference/${name}.ts`, new Set([...shaders, ...libraries])],
  ] as const;
  const found = kinds.flatMap(([files, pathOf, owners]) => [
    ...[...shaders].filter((name) => !files.has(name)).map((name) => [pathOf(name), 'is missing'] as const),
    ...[...files].filter((name) => !owners.has(name)).map((name) => [pathOf(name), 'has no shader'] as const),
  ]);
  const needed = new Set<string>(found.map(([path]) => path));
  return [
    ...found.filter(([path]) => !Object.hasOwn(exceptions, path)).map(([path, flaw]) => `${path} ${flaw}`),
    ...Object.keys(exceptions).flatMap((path) =>
      needed.has(path) ? [] : `${path} is no exception any more`,
    ),
  ];
}

const FOLDERS = { shaders, hosts, gpuTests, references };
const without = (names: ReadonlySet<string>, name: string) =>
  new Set([...names].filter((each) => each !== name));

describe('every stage', () => {
  test('has a shader, a host, a reference and a GPU test of one basename, or a reason why not', () => {
    expect(shaders).toContain('project');
    expect(flaws(FOLDERS, EXCEPTIONS)).toEqual([]);
  });

  test('is reported if one of its files is missing', () => {
    const missing = {
      ...FOLDERS,
      gpuTests: without(gpuTests, 'plan-cull'),
      references: without(references, 'pick'),
    };
    expect(flaws(missing, EXCEPTIONS)).toEqual([
      'stages/plan-cull.gpu.test.ts is missing',
      'reference/pick.ts is missing',
    ]);
  });

  test('is reported if only its shader is missing', () => {
    expect(flaws({ ...FOLDERS, shaders: without(shaders, 'pick') }, EXCEPTIONS)).toEqual([
      'stages/pick.ts has no shader',
      'stages/pick.gpu.test.ts has no shader',
      'reference/pick.ts has no shader',
    ]);
  });

  test('reports unused exceptions', () => {
    expect(flaws(FOLDERS, { ...EXCEPTIONS, 'stages/pick.ts': 'for a test' })).toEqual([
      'stages/pick.ts is no exception any more',
    ]);
  });
});
