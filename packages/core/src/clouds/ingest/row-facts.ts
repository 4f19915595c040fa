import { INGEST_FACTS } from '../../data/layout/ingest-facts.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { reachesOf } from '../../data/packing/band-reach.ts';
import { type CloudFacts, trueShDegree } from '../../data/packing/cloud-facts.ts';
import type { RowLayout } from '../../data/packing/row-layout.ts';
import { DROP_REASONS, type DropCounts } from '../../data/splats/splat-set.ts';

/** Statistics of the rows of a file, computed by ingest-rows. */
export interface RowFacts {
  /** Count of kept rows. */
  readonly count: number;
  readonly dropped: DropCounts;
  /** Bounds of the centres, relative to the layout's origin like the rows. */
  readonly min: Vec3;
  readonly max: Vec3;
  readonly facts: CloudFacts;
}

/** Decodes the statistics that ingest-rows writes. Bounds are undefined if no row was kept. */
export function readRowFacts(
  words: Uint32Array,
  {
    count: rows,
    shDegree,
    isAntialiased,
    fileFacts,
  }: Pick<RowLayout, 'count' | 'shDegree' | 'isAntialiased' | 'fileFacts'>,
): RowFacts {
  const c = INGEST_FACTS;
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  const largest = (word: number) => fromOrderedBits(words[word]);
  const smallest = (word: number) => fromOrderedBits(~words[word] >>> 0);
  const dropped: DropCounts = {};
  let count = rows;
  for (const [i, reason] of DROP_REASONS.entries()) {
    const rowsDropped = words[c.FACT_DROPPED + i];
    if (rowsDropped > 0) dropped[reason] = rowsDropped;
    count -= rowsDropped;
  }
  const axes = [0, 1, 2];
  const [minX, minY, minZ] = axes.map((axis) => smallest(c.FACT_MIN_POSITION + axis));
  const [maxX, maxY, maxZ] = axes.map((axis) => largest(c.FACT_MAX_POSITION + axis));
  const shBandReach = reachesOf(Array.from(floats.subarray(c.FACT_REACH, c.FACT_REACH + shDegree)));
  return {
    count,
    dropped,
    min: [minX, minY, minZ],
    max: [maxX, maxY, maxZ],
    facts: {
      declaredShDegree: shDegree,
      trueShDegree: trueShDegree(shBandReach),
      shBandReach,
      paletteEntries: null,
      isIsotropic: words[c.FACT_STRETCHED] === 0,
      isAntialiased: isAntialiased ?? null,
      fileFacts: fileFacts ?? null,
    },
  };
}

const f32 = new Float32Array(1);
const u32 = new Uint32Array(f32.buffer);

/** The float32 whose ordered bits, as lib/float-bits.wgsl makes them, are `ordered`. */
function fromOrderedBits(ordered: number): number {
  u32[0] = ordered >>> 31 === 1 ? ordered & 0x7fffffff : ~ordered;
  return f32[0];
}
