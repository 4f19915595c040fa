import { dirname } from 'node:path';
import { describe, expect, test } from 'vitest';
import index from '../../../../shaders/README.md?raw';
import { allStageVariants } from '../testing/stage-variants.ts';

const files = Object.keys(import.meta.glob('./*/*.{wgsl,ts}')).map((path) => path.slice('./'.length));

/** Files that belong to no single stage, and why. */
const OWN_ROOMS: Readonly<Record<string, string>> = {
  'sort/radix-sort.gpu.test.ts': 'compares the stages of the sort together with a sort on the CPU',
  'sort/radix-sort.ts': 'runs the stages of the sort together',
  'tiles/tile-lists.gpu.test.ts': 'checks the stages together that list bins and tiles for any splat',
};

/** Lists missing files of families, files that belong to no stage, and unused exceptions. */
function flaws(paths: readonly string[], ownRooms: Readonly<Record<string, string>>): string[] {
  const known = new Set(paths);
  const families = new Set(paths.map((path) => path.split('/')[0]));
  const shaders = paths
    .filter((path) => path.endsWith('.wgsl'))
    .map((path) => path.slice(0, -'.wgsl'.length));
  const needed = [
    ...Array.from(families, (name) => [`${name}/${name}.ts`, `${name}/${name}.reference.ts`]).flat(),
    ...shaders.map((path) => `${path}.gpu.test.ts`),
  ];
  const owned = new Set([
    ...needed,
    ...shaders.map((path) => `${path}.wgsl`),
    ...Array.from(families, (name) => `${name}/${name}.texts.ts`),
  ]);
  const isOwned = (path: string) => owned.has(path) || path.endsWith('.reference.test.ts');
  return [
    ...needed.filter((path) => !known.has(path)).map((path) => `${path} is missing`),
    ...paths
      .filter((path) => !isOwned(path) && !Object.hasOwn(ownRooms, path))
      .map((path) => `${path} belongs to no stage`),
    ...Object.keys(ownRooms)
      .filter((path) => !known.has(path) || isOwned(path))
      .map((path) => `${path} is no exception any more`),
  ];
}

describe('every stage', () => {
  test('has a shader and a GPU test of one basename, and its family a host and a reference', () => {
    expect(files).toContain('project/project.wgsl');
    expect(flaws(files, OWN_ROOMS)).toEqual([]);
  });

  test.each(['cull/plan-cull.gpu.test.ts', 'pick/pick.ts', 'pick/pick.reference.ts'])(
    'is reported if %s is missing',
    (path) => {
      expect(
        flaws(
          files.filter((each) => each !== path),
          OWN_ROOMS,
        ),
      ).toEqual([`${path} is missing`]);
    },
  );

  test('is reported if its shader is missing', () => {
    expect(
      flaws(
        files.filter((each) => each !== 'pick/pick.wgsl'),
        OWN_ROOMS,
      ),
    ).toEqual(['pick/pick.gpu.test.ts belongs to no stage']);
  });

  test('reports unused exceptions', () => {
    expect(flaws(files, { ...OWN_ROOMS, 'pick/pick.ts': 'for a test' })).toEqual([
      'pick/pick.ts is no exception any more',
    ]);
  });
});

/** Stages of features, which have their other files beside them. The motion is an effect. */
const ofFeatures = Object.keys(import.meta.glob(['../features/*/*.{wgsl,ts}', '!../features/motion/*']));

describe('every stage of a feature', () => {
  test('has a GPU test of its basename, and its folder a host and a reference', () => {
    const shaders = ofFeatures.filter((path) => path.endsWith('.wgsl'));
    expect(shaders.length).toBeGreaterThan(3);
    for (const path of shaders) {
      expect(ofFeatures).toContain(path.replace(/wgsl$/, 'gpu.test.ts'));
      const beside = ofFeatures.filter((each) => dirname(each) === dirname(path));
      for (const tier of ['stages', 'reference'])
        expect(beside.some((each) => each.endsWith(`.${tier}.ts`))).toBe(true);
    }
  });
});

describe('every family', () => {
  test('is in the index of shaders, with its stages', () => {
    const listed = [...index.matchAll(/\/src\/((?:stages|features)\/[^)]*\.wgsl)\)/g)].map(
      ([, path]) => path,
    );
    const shaders = [
      ...files.map((path) => `stages/${path}`),
      ...ofFeatures.map((path) => path.slice('../'.length)),
    ];
    expect(listed.toSorted()).toEqual(shaders.filter((path) => path.endsWith('.wgsl')).toSorted());
  });

  test('brings the files of the library that its stages import, and no others', async () => {
    const library = import.meta.glob<string>('../../../../shaders/lib/*.wgsl', {
      query: '?raw',
      import: 'default',
      eager: true,
    });
    const importsOf = (text: string): string[] =>
      [...text.matchAll(/\bimport (package::lib::(\w+))::/g)].flatMap(([, module, name]) => {
        const path = `../../../../shaders/lib/${name.replaceAll('_', '-')}.wgsl`;
        return [module, ...importsOf(library[path])];
      });
    const families = new Map<string, Set<string>>();
    const variants = await allStageVariants();
    for (const { texts } of variants) {
      const modules = Object.keys(texts!.modules).filter((name) => name.startsWith('package::lib::'));
      // Stages of other families may need some of them too.
      const needed = families.get(modules.join()) ?? new Set();
      families.set(modules.join(), needed);
      for (const text of Object.values(texts!.modules)) for (const name of importsOf(text)) needed.add(name);
    }
    expect(families.size).toBeGreaterThan(5);
    const inEngine = variants.find(({ stage }) => stage === 'composite')!.texts!.modules;
    const needless = [...families].flatMap(([modules, needed]) =>
      modules.split(',').filter((name) => !Object.hasOwn(inEngine, name) && !needed.has(name)),
    );
    expect(needless).toEqual([]);
  });
});
