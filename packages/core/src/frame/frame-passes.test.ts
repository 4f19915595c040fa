// Proves: the table of passes binds what the shaders declare, and README.md prints it.
import { describe, expect, test } from 'vitest';
import { internAccuracy } from '../data/accuracy/accuracy.ts';
import { effectSetOf, NO_EFFECTS } from '../gpu/effects/effect-set.ts';
import { reveal } from '../gpu/effects/reveal/reveal.ts';
import { type StageDefinition, shaderBindings } from '../gpu/pipelines.ts';
import { linkShader, loadVariant } from '../gpu/shaders/link-shader.ts';
import { cullSplats } from '../stages/cull/cull.ts';
import { project } from '../stages/project/project.ts';
import { wideKeys } from '../stages/wide-keys/wide-keys.ts';
import { CULL, PROJECT } from '../testing/effect-stages.ts';
import { allStageVariants } from '../testing/stage-variants.ts';
import { DRAW_PASSES, ORDER_PASSES, type StageRow, stagesOf } from './frame-passes.ts';
import type { FrameShape } from './plan/frame-shape.ts';
import readme from './README.md?raw';

const BASE = {
  clouds: [
    {
      cloud: { shDegree: 3 },
      planes: { pages: [{}], geometryPrecision: 'packed', shPrecision: 'u8' },
      levels: {},
      isTouched: false,
      effects: NO_EFFECTS,
      instanceCount: null,
      shDegree: 3,
      isIsotropic: false,
    },
  ],
  isBudgeted: true,
  accuracy: internAccuracy({ preset: 'balanced', resolutionScale: 0.5 }),
  sortDevice: { workgroupBytes: 16_384, isNarrow: true, ballots: null },
  keyBits: 64,
  depth: null,
  rasterizer: 'tiles',
  binCount: 4,
};
const TESTED = { mapping: 'projection', compare: 'less-equal', isTested: true, layerFormat: null };
/** Shapes that run all stages together. */
const SHAPES = [
  { output: { kind: 'host' }, depth: TESTED },
  { output: { kind: 'canvas', format: 'bgra8unorm', storable: null } },
  {
    output: { kind: 'canvas', format: 'bgra8unorm', storable: 'bgra8unorm' },
    sortDevice: { ...BASE.sortDevice, isNarrow: false },
  },
].map((own) => ({ ...BASE, ...own }) as unknown as FrameShape);

/** Names of the stages of a row. */
function namesOf(row: StageRow): string[] {
  const stages = SHAPES.flatMap((shape) => stagesOf(shape).get(row)!.flat()).filter(
    (stage) => stage !== null,
  );
  return [...new Set(stages.map((each) => ('stage' in each ? each : each[0]).stage))];
}

/** A name in a shader, and the resource that is bound there. */
interface Binding {
  readonly name: string;
  readonly resource: string;
}

function bindingsIn(names: string): Binding[] {
  return names
    .split(' ')
    .filter(Boolean)
    .map((each) => {
      const [name, resource = name] = each.split('=');
      return { name, resource };
    });
}

const rows = [...ORDER_PASSES, ...DRAW_PASSES].flatMap(({ label, stages }) =>
  stages.map((row, i) => ({
    label: i === 0 ? label : '',
    row,
    stages: namesOf(row),
    reads: bindingsIn(row.reads ?? ''),
    writes: bindingsIn(row.writes),
  })),
);

/** By stage, what the shaders bind: by name, in how many of the variants, and whether they write it. */
async function boundBy() {
  const variants = new Map<string, StageDefinition[]>();
  const effects = effectSetOf([reveal({ from: 'camera', radius: 1 })]);
  const withEffects = [
    cullSplats({ ...CULL, effects }),
    project({ ...PROJECT, effects }),
    await loadVariant(wideKeys({ geometryPrecision: 'packed', effects })),
  ];
  for (const variant of [...(await allStageVariants()), ...withEffects])
    variants.set(variant.stage, [...(variants.get(variant.stage) ?? []), variant]);
  return new Map(
    Array.from(variants, ([stage, all]) => {
      const bound = all
        .flatMap((variant) => shaderBindings(linkShader(variant)))
        // Bound for effects, beside the row.
        .filter(({ name }) => name !== 'effects');
      const listed = (isWritten: boolean) => {
        const some = bound.filter(
          ({ entry }) =>
            (entry.buffer?.type === 'storage' || entry.storageTexture !== undefined) === isWritten,
        );
        const names = [...new Set(some.map(({ name }) => name))].sort();
        const optional = names.filter(
          (name) => some.filter((each) => each.name === name).length < all.length,
        );
        return { names, optional };
      };
      return [stage, { reads: listed(false), writes: listed(true) }] as const;
    }),
  );
}

/** What the CPU writes, the clouds hold, or the host has drawn. */
const GIVEN = new Set(
  'view page pages chunks geometry shRest links cells cuts cutPlan widePlaces cullParameters grid hostDepth hostDepths viewport behind fade upscaleParameters compositeParameters'.split(
    ' ',
  ),
);

describe('the table of passes', async () => {
  const bound = await boundBy();

  test('names what the shaders of each stage read and write', () => {
    const sorted = (bindings: readonly Binding[]) => bindings.map(({ name }) => name).sort();
    for (const { row, stages, reads, writes } of rows) {
      // Sorts bind their stages themselves.
      if ('dispatches' in row) continue;
      expect(stages).toHaveLength(1);
      const [stage] = stages;
      expect(sorted(reads), stage).toEqual(bound.get(stage)!.reads.names);
      if (!('draws' in row)) expect(sorted(writes), stage).toEqual(bound.get(stage)!.writes.names);
    }
  });

  test('has no stage that reads what no earlier one has written', () => {
    const written = new Set<string>();
    for (const [i, { stages, reads, writes }] of rows.entries()) {
      const isLast = rows.findLastIndex((row) => row.stages[0] === stages[0]) === i;
      for (const { name, resource } of reads) {
        // Of a stage that runs twice, the second variant may read what comes between.
        const isLater = !isLast && bound.get(stages[0])!.reads.optional.includes(name);
        if (!GIVEN.has(resource) && !isLater)
          expect(written, `${stages} reads ${resource}`).toContain(resource);
      }
      for (const { resource } of writes) written.add(resource);
    }
  });

  test('is printed in README.md', () => {
    const printed = rows.map(({ label, row, stages, reads, writes }) => {
      const cell = (bindings: readonly Binding[], optional: readonly string[] = []) =>
        bindings
          .map(({ name, resource }) => {
            const text = name === resource ? `\`${name}\`` : `\`${resource}\` as \`${name}\``;
            return optional.includes(name) ? `(${text})` : text;
          })
          .join(', ');
      const { reads: read, writes: write } = bound.get(stages[0])!;
      const isSort = 'dispatches' in row;
      const names = stages.map((stage) => `\`${stage}\``).join(', ');
      return [
        label,
        names,
        cell(reads, isSort ? [] : read.optional),
        cell(writes, isSort ? [] : write.optional),
      ];
    });
    const section = readme.slice(readme.indexOf('| pass | stage |'), readme.indexOf('## Cut, cull, project'));
    const found = section
      .trim()
      .split('\n')
      .slice(2)
      .map((line) => line.split('|').map((each) => each.trim()))
      .map(([, label, stage, , , reads, writes]) => [label, stage, reads, writes]);
    expect(found).toEqual(printed);
  });
});
