import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { ChunkParameters, MortonParameters, PermuteParameters } from '../../data/layout/packing-structs.ts';
import { Chunk } from '../../data/layout/structs.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { shBytesPerSplat, shWordsPerSplat } from '../../data/packing/harmonics.ts';
import type { MortonFrame } from '../../data/packing/morton-order.ts';
import type { RowPrecision } from '../../data/packing/precision.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import { recordDispatches } from '../../gpu/passes.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import { ingestGather } from '../../stages/gather/gather.ts';
import { ingestChunks, ingestKeys, ingestScatter } from '../../stages/ingest/ingest.ts';
import { RadixSort, radixSortStages } from '../../stages/sort/radix-sort.ts';
import { pairSortShapeFor, type SortShape, sortPlanOf } from '../../stages/sort/sort.ts';
import type { PageRange, Plane } from '../cloud-planes.ts';
import { type DispatchContext, Dispatches } from './dispatches.ts';

/** Planes in file order, with a slot per row. */
export interface ArrivedPlanes extends RowPrecision {
  readonly name: string;
  /** Pages of the slots. */
  readonly ranges: readonly PageRange[];
  readonly geometry: Plane;
  readonly harmonics: Plane;
  /** Degree of `harmonics`. */
  readonly shDegree: ShDegree;
  /** A bit per slot: 1 if its row was dropped. */
  readonly dropMask: GPUBuffer;
  /** Count of kept rows, at least 1. */
  readonly kept: number;
  /** Whether memory has room for smaller planes if the given ones are roomy: see `isRoomy`. */
  readonly hasRoom: boolean;
  /** Origin to subtract from positions, in the space of the rows. */
  readonly origin: Vec3;
  readonly frame: MortonFrame;
  /**
   * `Chunk` structs as written by ingest-rows, and fractions of packed log scales; null for f32.
   */
  readonly arrivedChunks: GPUBuffer;
  readonly logScaleRests: GPUBuffer | null;
  /** Degree to keep, at most `shDegree`. */
  readonly keptShDegree: ShDegree;
  /**
   * Pages of the planes in storage order, for `kept` splats. Default: the given pages, cut off
   * after `kept` slots.
   */
  readonly pages?: readonly PageRange[];
}

/** Planes in storage order. */
export interface ArrangedPlanes {
  readonly ranges: readonly PageRange[];
  readonly geometry: Plane;
  readonly harmonics: Plane;
  readonly chunks: Plane;
  /** Row in the file per splat, then the dropped rows. */
  readonly fileRows: GPUBuffer;
}

/**
 * Smaller planes are made, instead of reordering in place, if more than this share of the slots was
 * dropped.
 */
const SPARE_PART = 1 / 16;

/** Whether planes with this many slots are much larger than `kept` rows need. */
export function isRoomy(kept: number, slots: number): boolean {
  return kept < (1 - SPARE_PART) * slots;
}

/** Passes of the sort by Morton codes; each sorts by eight bits. */
const ROUNDS = 6;
/** Bits of the sort keys. A ninth bit sorts dropped rows behind all others. */
const KEY_BITS = { none: 8, some: 9 } as const;

/**
 * A sort in one pass, which needs no second buffer of keys. The saved memory holds the fractions of
 * log scales.
 */
function sortShapeOf(dropped: keyof typeof KEY_BITS): SortShape {
  return pairSortShapeFor(KEY_BITS[dropped]);
}

/** Lists the stages that `arrangePlanes` runs. */
export function arrangeStages(
  { geometryPrecision }: Pick<RowPrecision, 'geometryPrecision'>,
  hasDrops: boolean,
) {
  return [
    ingestKeys(geometryPrecision),
    ...radixSortStages(sortShapeOf(hasDrops ? 'some' : 'none')),
    ingestGather,
    ingestScatter,
    ingestChunks(geometryPrecision),
  ] satisfies StageDefinition[];
}

/**
 * Puts planes into storage order on the GPU. Splats are sorted by Morton code and moved two words
 * at a time. They are moved in place if pages and degree stay, and if few rows were dropped or
 * memory lacks room. So at most 16 bytes per splat are needed besides the planes; 4 of these, the
 * rows of the file, remain. Then the origin is subtracted from positions, and log scales are
 * quantised over their chunk's range. Frees the planes that it replaces. All stages must have been
 * compiled. Submits without waiting.
 *
 * @throws GpuLimitError; the given planes are then left to the caller, in undefined order.
 */
export function arrangePlanes(context: DispatchContext, arrived: ArrivedPlanes): ArrangedPlanes {
  const { memory } = context;
  const made: GPUBuffer[] = [];
  const create = (label: string, bytes: number) => {
    const buffer = memory.createBuffer(label, bytes, storageUsage());
    made.push(buffer);
    return buffer;
  };
  try {
    const fileRows = create(`${arrived.name} file rows`, 4 * slotsOf(arrived.ranges));
    sortSplats(context, arrived, fileRows);
    return permute(context, arrived, fileRows, create);
  } catch (error) {
    for (const buffer of made) memory.destroy(buffer);
    throw error;
  }
}

/** A function, because Node has no `GPUBufferUsage` before a GPU is opened. */
function storageUsage(): GPUBufferUsageFlags {
  return GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC | GPUBufferUsage.COPY_DST;
}

const workgroupsFor = (threads: number) => Math.ceil(threads / CHUNK_SPLATS);

function slotsOf(ranges: readonly PageRange[]): number {
  return ranges.at(-1)?.end ?? 0;
}

/** Writes slots, which are rows of the file, to `fileRows`: kept rows first, in storage order. */
function sortSplats(
  context: DispatchContext,
  { ranges, geometry, geometryPrecision, dropMask, kept, origin, frame }: ArrivedPlanes,
  fileRows: GPUBuffer,
): void {
  const { device, pipelines, dispatchRow } = context;
  const memory = context.memory.part();
  const slots = slotsOf(ranges);
  try {
    const shape = sortShapeOf(kept < slots ? 'some' : 'none');
    const sort = new RadixSort(device, pipelines, memory, {
      shape,
      plan: memory.createFilledBuffer('ingest plan', sortPlanOf(slots, shape)),
      capacity: slots,
      dispatchRow,
      payloads: 'given',
      order: fileRows,
      label: 'ingest',
    });
    const dispatches = new Dispatches(context);
    const stage = ingestKeys(geometryPrecision);
    for (let round = 0; round < ROUNDS; round++) {
      for (const [page, { start, end }] of ranges.entries()) {
        const parameters = MortonParameters.pack({
          ...frame,
          round,
          origin,
          pageStart: start,
          pageEnd: end,
          slotCount: slots,
          dispatchRow,
        });
        const bindings = { geometry: geometry[page], dropMask, order: fileRows, ...sort.input };
        dispatches.add(stage, parameters, bindings, workgroupsFor(slots));
      }
      dispatches.call((pass) => recordDispatches(pass, sort.dispatches));
    }
    dispatches.submit('ingest sort');
  } finally {
    memory.destroyAll();
  }
}

/** A plane before and after reordering. */
interface Move {
  readonly from: Plane;
  readonly to: Plane;
  readonly wordsBefore: number;
  readonly words: number;
  /** Mask of the used bits of the last word. */
  readonly lastMask: number;
}

function permute(
  context: DispatchContext,
  arrived: ArrivedPlanes,
  fileRows: GPUBuffer,
  create: (label: string, bytes: number) => GPUBuffer,
): ArrangedPlanes {
  const { device, memory, dispatchRow } = context;
  const { name, kept, geometryPrecision, shPrecision, shDegree, keptShDegree } = arrived;
  const filled = arrived.ranges
    .filter(({ start }) => start < kept)
    .map(({ start, end }) => ({ start, end: Math.min(end, kept) }));
  const ranges = arrived.pages ?? filled;
  const isRepaged = ranges.length !== filled.length || ranges.some(({ end }, i) => end !== filled[i].end);
  const isShrunk = arrived.hasRoom && isRoomy(kept, slotsOf(arrived.ranges));
  const planeOf = (what: string, words: number): Plane =>
    ranges.map(({ start, end }, page) => create(`${name} ${what} ${page}`, 4 * words * (end - start)));
  const moveOf = (what: string, from: Plane, wordsBefore: number, words: number, lastMask: number): Move => {
    const isNew = words > 0 && (isShrunk || isRepaged || words !== wordsBefore);
    return {
      from,
      to: isNew ? planeOf(what, words) : from.slice(0, ranges.length),
      wordsBefore,
      words,
      lastMask,
    };
  };
  const geometryWords = GEOMETRY_WORDS[geometryPrecision];
  const shWords = shWordsPerSplat(keptShDegree, shPrecision);
  const spareBytes = 4 * shWords - shBytesPerSplat(keptShDegree, shPrecision);
  const geometry = moveOf('geometry', arrived.geometry, geometryWords, geometryWords, 0xffffffff);
  const harmonics = moveOf(
    'spherical harmonics',
    arrived.harmonics,
    shWordsPerSplat(shDegree, shPrecision),
    shWords,
    0xffffffff >>> (8 * spareBytes),
  );
  const chunks = ranges.map(({ start, end }, page) =>
    create(`${name} chunks ${page}`, Chunk.bytes * chunkCountOf(end - start)),
  );
  const wordsAtOnce = 8 * kept <= device.limits.maxStorageBufferBindingSize ? 2 : 1;
  const words = memory.createBuffer('ingest words', 4 * wordsAtOnce * kept, storageUsage());
  try {
    const dispatches = new Dispatches(context);
    for (const move of [geometry, harmonics]) {
      addMove(dispatches, move, {
        before: arrived.ranges,
        after: ranges,
        list: fileRows,
        words,
        wordsAtOnce,
        kept,
        dispatchRow,
      });
    }
    const { origin, arrivedChunks, logScaleRests } = arrived;
    for (const [page, { start, end }] of ranges.entries()) {
      const parameters = ChunkParameters.pack({
        origin,
        firstSplat: start,
        splatCount: end - start,
        dispatchRow,
      });
      const bindings = {
        geometry: geometry.to[page],
        chunks: chunks[page],
        ...(logScaleRests && { fileRows, arrivedChunks, logScaleRests }),
      };
      dispatches.add(ingestChunks(geometryPrecision), parameters, bindings, chunkCountOf(end - start));
    }
    dispatches.submit('ingest arrange');
  } finally {
    memory.destroy(words);
  }
  for (const { from, to, words } of [geometry, harmonics]) {
    for (const buffer of from) if (words === 0 || !to.includes(buffer)) memory.destroy(buffer);
  }
  return { ranges, geometry: geometry.to, harmonics: shWords > 0 ? harmonics.to : [], chunks, fileRows };
}

interface Moving {
  readonly before: readonly PageRange[];
  readonly after: readonly PageRange[];
  readonly list: GPUBuffer;
  /** `wordsAtOnce` per splat. */
  readonly words: GPUBuffer;
  readonly wordsAtOnce: number;
  readonly kept: number;
  readonly dispatchRow: number;
}

function addMove(
  dispatches: Dispatches,
  { from, to, wordsBefore, words: wordCount, lastMask }: Move,
  { before, after, list, words, wordsAtOnce, kept, dispatchRow }: Moving,
): void {
  for (let word = 0; word < wordCount; word += wordsAtOnce) {
    const endWord = Math.min(word + wordsAtOnce, wordCount);
    const parametersOf = ({ start, end }: PageRange, wordsPerSplat: number) =>
      PermuteParameters.pack({
        word,
        words: endWord - word,
        wordsPerSplat,
        mask: endWord === wordCount ? lastMask : 0xffffffff,
        pageStart: start,
        pageEnd: end,
        count: kept,
        dispatchRow,
      });
    for (const [page, range] of before.entries()) {
      const bindings = { plane: from[page], list, words };
      dispatches.add(ingestGather, parametersOf(range, wordsBefore), bindings, workgroupsFor(kept));
    }
    for (const [page, range] of after.entries()) {
      const bindings = { words, plane: to[page] };
      dispatches.add(
        ingestScatter,
        parametersOf(range, wordCount),
        bindings,
        workgroupsFor(range.end - range.start),
      );
    }
  }
}
