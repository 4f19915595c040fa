import { describe, expect, test } from 'vitest';
import { type StageDefinition, shaderBindings } from '../gpu/pipelines.ts';
import { linkShader } from '../gpu/shaders/link-shader.ts';
import { allStageVariants } from '../testing/stage-variants.ts';
import readme from './README.md?raw';

/** A row of the table: what a stage reads and writes, `(name)` for what only some variants bind. */
interface Row {
  readonly stage: string;
  readonly reads: readonly string[];
  readonly writes: readonly string[];
}

const namesIn = (cell: string) => cell.replaceAll('`', '').split(', ').filter(Boolean).sort();

const rows: readonly Row[] = readme.split('\n').flatMap((line) => {
  const [, , stage, , , reads, writes] = line.split('|').map((cell) => cell.trim());
  return writes !== undefined && /^`[\w-]+`$/.test(stage)
    ? [{ stage: stage.replaceAll('`', ''), reads: namesIn(reads), writes: namesIn(writes) }]
    : [];
});

/** What the shaders of a stage bind in any variant. */
async function boundBy(): Promise<Map<string, Row>> {
  const variants = new Map<string, StageDefinition[]>();
  for (const variant of await allStageVariants())
    variants.set(variant.stage, [...(variants.get(variant.stage) ?? []), variant]);
  return new Map(
    Array.from(variants, ([stage, all]) => {
      const bound = all.flatMap((variant) => shaderBindings(linkShader(variant)));
      const named = (isWritten: boolean) => {
        const some = bound.filter(
          ({ entry }) =>
            (entry.buffer?.type === 'storage' || entry.storageTexture !== undefined) === isWritten,
        );
        return [...new Set(some.map(({ name }) => name))]
          .map((name) => (some.filter((each) => each.name === name).length < all.length ? `(${name})` : name))
          .sort();
      };
      return [stage, { stage, reads: named(false), writes: named(true) }];
    }),
  );
}

/** Where the names of a sort, of tile lists and of layers differ from the buffers that others give them. */
const ALIASES: Readonly<Record<string, string>> = {
  keysIn: 'keys',
  pairOffsets: 'keys',
  digitOffsets: 'digitCounts',
  // A sort of pairs runs between tile-emit and tile-ranges.
  sortedBins: 'pairBins',
  sortedRecords: 'pairRecords',
  // The sort's result.
  order: 'payloadsOut',
  payloads: 'payloadsOut',
  payloadsIn: 'payloadsOut',
  plan: 'depthSortPlan',
  tileGrid: 'grid',
};
/** What the CPU writes, the clouds hold, or the host has drawn. */
const GIVEN = new Set(
  'view page pages chunks geometry shRest links cells cuts cutPlan widePlaces cullParameters parameters grid hostDepth hostDepths viewport behind fade testedDepth layer depthLayer'.split(
    ' ',
  ),
);

describe('the table of passes in README.md', () => {
  test('names what the shaders of each stage read and write', async () => {
    const bound = await boundBy();
    expect(rows.length).toBeGreaterThan(20);
    for (const row of rows) expect(row).toEqual(bound.get(row.stage));
  });

  test('has no stage that reads what no earlier one has written', () => {
    const written = new Set<string>();
    for (const [i, { stage, reads, writes }] of rows.entries()) {
      const isLast = rows.findLastIndex((row) => row.stage === stage) === i;
      for (const name of reads) {
        const bare = name.replace(/[()]/g, '');
        const buffer = ALIASES[bare] ?? bare;
        // Each pass of a sort reads what the one before has written.
        const own = writes.some((each) => each.replace(/[()]/g, '') === buffer);
        // Of a stage that runs twice, the second variant may read what comes between.
        const isLater = name !== bare && !isLast;
        if (!GIVEN.has(bare) && !own && !isLater) expect(written, `${stage} reads ${name}`).toContain(buffer);
      }
      for (const name of writes) written.add(name.replace(/[()]/g, ''));
    }
  });
});
