import { CloudPlanes } from '../clouds/cloud-planes.ts';
import { CloudLevels } from '../clouds/levels/cloud-levels.ts';
import { cellCounts } from '../data/layout/cell-counts.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { ChunkLinks, LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import { chunkCountOf } from '../data/packing/chunks.ts';
import { type PackedHarmonics, readCoefficients, shWordsPerSplat } from '../data/packing/harmonics.ts';
import type { PackedCloud } from '../data/packing/packed-cloud.ts';
import { BLOB_PRECISION } from '../data/packing/precision.ts';
import { coefficientsPerSplat, type ShDegree } from '../data/splats/splat-set.ts';
import { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines } from '../gpu/pipelines.ts';
import { linkParts } from '../reference/level-link.ts';
import { type Merged, mergedOf } from '../reference/merged-splat.ts';
import { type ReferenceSplat, unpackSplat } from '../reference/packing.ts';
import type { TestGpu } from './test-gpu.ts';

/** Words before the links of a chunk. */
const HEAD_WORDS = ChunkLinks.words - CHUNK_SPLATS;

/** A splat, or a blob, as the GPU has linked it. */
export interface MadeNode {
  readonly cell: number;
  readonly isBlob: boolean;
  readonly slot: number;
  readonly link: number;
  readonly splat: ReferenceSplat;
  readonly merged: Merged;
  readonly coefficients: Float64Array;
}

/** The leaves and blobs of one cell as the GPU made them, by slot; null in unused slots. */
export interface MadeCell {
  readonly leaves: readonly (MadeNode | undefined)[];
  readonly blobs: readonly (MadeNode | undefined)[];
  /** Words before the links of both chunks. */
  readonly leafHead: Uint32Array;
  readonly blobHead: Uint32Array;
}

/** Predicates of edited, hidden and selected splats by index in storage order: input of touch-links. */
export interface TouchedBy {
  readonly edited?: (splat: number) => boolean;
  readonly hidden?: (splat: number) => boolean;
  readonly selections?: readonly ((splat: number) => boolean)[];
}

/**
 * Makes the levels of a cloud on the GPU, refines the links of `touched` splats, and reads all back,
 * by cell.
 */
export async function madeLevels(
  gpu: TestGpu,
  packed: PackedCloud,
  {
    pipelines = gpu.pipelines,
    bytesPerPage = Number.POSITIVE_INFINITY,
    dispatchRow = 3,
    submissionBudgetMs = Number.POSITIVE_INFINITY,
    touched,
  }: {
    pipelines?: Pipelines;
    bytesPerPage?: number;
    dispatchRow?: number;
    submissionBudgetMs?: number;
    touched?: TouchedBy;
  } = {},
): Promise<MadeCell[]> {
  const { device } = gpu;
  const memory = new GpuMemory(device);
  const maxBufferSize = Math.min(device.limits.maxBufferSize, bytesPerPage);
  const limits = { maxBufferSize, maxStorageBufferBindingSize: maxBufferSize };
  const planes = CloudPlanes.upload(memory, limits, packed, 'cloud');
  const cloud = { name: 'cloud', count: packed.count, chunks: packed.chunks, planes };
  const context = { device, pipelines, memory, dispatchRow, submissionBudgetMs };
  const levels = await CloudLevels.make(context, cloud, () => {});
  const refined = touched && levels.refinement.make(context);
  if (refined) {
    const { edited, hidden, selections = [] } = touched;
    const bitsOf = (isSet: (splat: number) => boolean = () => false, from = 0, end = packed.count) => {
      const bits = new Uint32Array(Math.ceil((end - from) / 32));
      for (let i = from; i < end; i++) if (isSet(i)) bits[(i - from) >>> 5] |= 1 << ((i - from) % 32);
      return bits;
    };
    await pipelines.prepare(levels.refinement.stages);
    const feature = { touched: { edited: bitsOf(edited), hidden: bitsOf(hidden), version: 1, count: 1 } };
    const precision = {
      geometryPrecision: packed.geometry.precision,
      shPrecision: packed.harmonics.precision,
    };
    refined.update(
      { instance: { cloud: { chunks: packed.chunks, features: [feature] } }, uses: [] },
      planes.pagesFor(precision).pages.map(({ chunks }, page) => {
        const { start, end } = planes.ranges[page];
        const selected = selections.flatMap((isSelected) => [...bitsOf(isSelected, start, end)]);
        return { chunks, ...(selections.length > 0 && { selectedBits: gpu.storage(selected) }) };
      }),
    );
  }
  const read = (buffer: GPUBuffer) => gpu.read(refined?.of(buffer) ?? buffer);
  const links = await Promise.all(levels.splatLinks.map(read));
  const splatLinks = links.flatMap((words) => Array.from(words));
  const blobs = await Promise.all(
    levels.blobPages.map(async (page) => ({
      words: await gpu.read(page.geometry),
      sh: page.shRest && (await gpu.read(page.shRest)),
      links: await read(page.links),
      chunkCount: page.chunkCount,
    })),
  );
  refined?.destroy();
  levels.destroy();
  planes.destroy();

  const degree = packed.harmonics.degree as ShDegree;
  const nodesOf = (cell: number, page: (typeof blobs)[number], chunk: number, isBlob: boolean) => {
    const own = page.links.subarray(chunk * ChunkLinks.words, (chunk + 1) * ChunkLinks.words);
    const geometry = { precision: 'f32' as const, words: page.words, chunks: new Float32Array(0) };
    const floats = new Float32Array(page.words.buffer);
    const nodes = Array.from({ length: CHUNK_SPLATS }, (_, slot): MadeNode | undefined => {
      const link = own[HEAD_WORDS + slot];
      if (link === 0) return undefined;
      const index = chunk * CHUNK_SPLATS + slot;
      const splat = unpackSplat(geometry, index);
      const merged = mergedOf(splat, [floats[16 * index + 11], floats[16 * index + 15]]);
      const coefficients = new Float64Array(coefficientsPerSplat(degree));
      if (page.sh) readCoefficients(harmonicsOf(degree, page.sh), index, coefficients);
      return { cell, isBlob, slot, link, splat, merged, coefficients };
    });
    return { head: own.subarray(0, HEAD_WORDS), nodes };
  };

  const counts = cellCounts(chunkCountOf(packed.count));
  return Array.from({ length: levels.cellCount }, (_, cell) => {
    if (cell >= counts[0]) {
      const page = blobs.at(-1)!;
      const leaves = nodesOf(cell, page, 2 * (cell - counts[0]), false);
      const made = nodesOf(cell, page, 2 * (cell - counts[0]) + 1, true);
      return { leaves: leaves.nodes, leafHead: leaves.head, blobs: made.nodes, blobHead: made.head };
    }
    let [page, chunk] = [0, cell];
    while (chunk >= blobs[page].chunkCount) chunk -= blobs[page++].chunkCount;
    const made = nodesOf(cell, blobs[page], chunk, true);
    const own = Uint32Array.from(splatLinks.slice(cell * ChunkLinks.words, (cell + 1) * ChunkLinks.words));
    const leaves = Array.from({ length: CHUNK_SPLATS }, (_, slot): MadeNode | undefined => {
      const index = cell * CHUNK_SPLATS + slot;
      if (index >= packed.count) return undefined;
      const splat = unpackSplat(packed.geometry, index);
      const coefficients = new Float64Array(coefficientsPerSplat(degree));
      readCoefficients(packed.harmonics, index, coefficients);
      return {
        cell,
        isBlob: false,
        slot,
        link: own[HEAD_WORDS + slot],
        splat,
        merged: mergedOf(splat),
        coefficients,
      };
    });
    return { leaves, leafHead: own.subarray(0, HEAD_WORDS), blobs: made.nodes, blobHead: made.head };
  });
}

function harmonicsOf(degree: ShDegree, words: Uint32Array): PackedHarmonics {
  const wordsPerSplat = shWordsPerSplat(degree, BLOB_PRECISION.shPrecision);
  return { degree, precision: BLOB_PRECISION.shPrecision, wordsPerSplat, words };
}

/** The nodes that each blob of a cell merges. */
export function childrenOf({ leaves, blobs }: MadeCell): ReadonlyMap<MadeNode, readonly MadeNode[]> {
  const children = new Map<MadeNode, MadeNode[]>();
  for (const blob of blobs) if (blob) children.set(blob, []);
  for (const node of [...leaves, ...blobs]) {
    if (!node || isRoot(node)) continue;
    const parent = blobs[linkParts(node.link).parentSlot];
    if (!parent) throw new Error(`Slot ${node.slot} of cell ${node.cell} has no parent.`);
    children.get(parent)!.push(node);
  }
  return children;
}

export function isRoot({ link }: MadeNode): boolean {
  return linkParts(link).parentError === LEVEL_CONSTANTS.ERROR_BOUNDLESS;
}
