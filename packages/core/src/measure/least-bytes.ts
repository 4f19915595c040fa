import { layerSize, type SizePx } from '../data/accuracy/accuracy.ts';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { Chunk, SPLAT_RECORDS } from '../data/layout/structs.ts';
import { GEOMETRY_WORDS } from '../data/packing/geometry.ts';
import { ENTRY_PRECISION, shWordsPerSplat } from '../data/packing/harmonics.ts';
import {
  type CloudShape,
  depthSortShape,
  type FrameShape,
  pairSortShape,
} from '../frame/plan/frame-shape.ts';
import type { FrameStatistics } from '../gpu/timing/frame-statistics.ts';
import { blockKeysOf, lowerPassesOf, type SortShape } from '../stages/sort/sort.ts';

/** Bytes that a pass moves between the GPU's memory and its cores. */
export interface PassBytes {
  readonly read: number;
  readonly written: number;
}

/** A frame that was drawn, without a host. */
export interface CountedFrame {
  readonly shape: FrameShape;
  readonly statistics: Pick<
    FrameStatistics,
    'candidateSplats' | 'visibleSplats' | 'rasterizer' | 'tilePairs'
  >;
  /** Size of the image. */
  readonly size: SizePx;
  /** Bytes of a pixel of the layer. */
  readonly pixelBytes: number;
}

/** The numbers that the bytes of passes follow from. */
interface Counts {
  readonly chunks: number;
  readonly visibleChunks: number;
  /** Splats of the visible chunks. */
  readonly candidates: number;
  readonly visible: number;
  /** Pairs that the tiles draw; 0 where quads draw. */
  readonly pairs: number;
  /** 1 where quads draw, 0 where their pass draws nothing. */
  readonly drawsQuads: number;
  readonly layerBytes: number;
  readonly imagePixels: number;
  readonly imageBytes: number;
  /** Mean bytes of a splat's planes; visible splats are taken to spread over clouds as all do. */
  readonly geometryBytes: number;
  readonly harmonicsBytes: number;
  /** Mean bytes of the range of a chunk's log scales. */
  readonly rangeBytes: number;
  /** Bytes of the entries of palettes that visible splats may have. */
  readonly entryBytes: number;
  readonly recordBytes: number;
  readonly depthSort: SortShape;
  readonly pairSort: SortShape;
}

type Rule = (counts: Counts) => readonly [readBytes: number, writtenBytes: number];

const WORD_BYTES = 4;
const { MASK_WORDS, BIN_TILES, TILE_COUNT_BLOCK } = SHADER_CONSTANTS;
/** Bits of one splat of a chunk, for each chunk. */
const CHUNK_MASK_BYTES = WORD_BYTES * MASK_WORDS;
const PAIR_MASK_BYTES = BIN_TILES ** 2 / 8;
const CANVAS_PIXEL_BYTES = 4;

/** The stages of a radix sort. */
function sortRules(
  shapeOf: (counts: Counts) => SortShape,
  keysOf: (counts: Counts) => number,
  has: { readonly givenPayloads: boolean; readonly givenFirstCounts: boolean; readonly sortedKeys: boolean },
): Record<string, Rule> {
  /** Bytes of a word per key in so many passes, and of the digit counts of as many. */
  const sizes = (counts: Counts) => {
    const shape = shapeOf(counts);
    const keys = keysOf(counts);
    const blocks = Math.ceil(keys / blockKeysOf(shape));
    return {
      passes: shape.passes,
      words: (passes: number) => passes * WORD_BYTES * keys,
      digitCounts: (passes: number) => passes * WORD_BYTES * 2 ** shape.digitBits * blocks,
    };
  };
  return {
    'sort-histogram': (counts) => {
      const { passes, words, digitCounts } = sizes(counts);
      const counted = passes - Number(has.givenFirstCounts);
      return [words(counted), digitCounts(counted)];
    },
    'sort-scan': (counts) => {
      const { passes, digitCounts } = sizes(counts);
      return [digitCounts(passes), digitCounts(passes)];
    },
    'sort-scatter': (counts) => {
      const { passes, words, digitCounts } = sizes(counts);
      const payloads = passes - Number(!has.givenPayloads);
      // The last pass over the lower words of wide keys writes none.
      const unwritten = lowerPassesOf(shapeOf(counts)) === null ? 0 : 1;
      const keys = passes - Number(!has.sortedKeys) - unwritten;
      return [words(passes + payloads) + digitCounts(passes), words(passes + keys)];
    },
  };
}

/** By the label of a frame's pass, then by stage. */
const RULES: Readonly<Record<string, Readonly<Record<string, Rule>>>> = {
  'pre-process': {
    'cull-chunks': ({ chunks }) => [Chunk.bytes * chunks, WORD_BYTES * chunks],
    'plan-cull': ({ chunks, visibleChunks }) => [WORD_BYTES * chunks, WORD_BYTES * (chunks + visibleChunks)],
    'cull-splats': ({ candidates, visibleChunks, geometryBytes, rangeBytes }) => [
      geometryBytes * candidates + (WORD_BYTES + rangeBytes) * visibleChunks,
      (CHUNK_MASK_BYTES + WORD_BYTES) * visibleChunks,
    ],
    'plan-project': ({ visibleChunks }) => [WORD_BYTES * visibleChunks, WORD_BYTES * visibleChunks],
    'compact-splats': ({ visibleChunks, visible }) => [
      (CHUNK_MASK_BYTES + 2 * WORD_BYTES) * visibleChunks,
      WORD_BYTES * visible,
    ],
    project: ({
      visible,
      visibleChunks,
      geometryBytes,
      rangeBytes,
      harmonicsBytes,
      entryBytes,
      recordBytes,
    }) => [
      (WORD_BYTES + geometryBytes + harmonicsBytes) * visible + rangeBytes * visibleChunks + entryBytes,
      (recordBytes + WORD_BYTES) * visible,
    ],
    'wide-keys': ({ visible, geometryBytes }) => [
      (WORD_BYTES + geometryBytes) * visible,
      2 * WORD_BYTES * visible,
    ],
  },
  sort: {
    ...sortRules(
      ({ depthSort }) => depthSort,
      ({ visible }) => visible,
      { givenPayloads: false, givenFirstCounts: false, sortedKeys: false },
    ),
    'sort-gather': ({ visible }) => [2 * WORD_BYTES * visible, WORD_BYTES * visible],
  },
  'tile lists': {
    'tile-count': ({ visible, recordBytes }) => [
      (WORD_BYTES + recordBytes) * visible,
      WORD_BYTES * visible + WORD_BYTES * Math.ceil(visible / TILE_COUNT_BLOCK),
    ],
    'tile-plan': ({ visible }) => {
      const words = WORD_BYTES * Math.ceil(visible / TILE_COUNT_BLOCK);
      return [words, words];
    },
    'tile-emit': ({ visible, pairs, recordBytes }) =>
      pairs === 0 ? [0, 0] : [(2 * WORD_BYTES + recordBytes) * visible, 2 * WORD_BYTES * pairs],
    ...sortRules(
      ({ pairSort }) => pairSort,
      ({ pairs }) => pairs,
      // tile-emit counts the first digits.
      { givenPayloads: true, givenFirstCounts: true, sortedKeys: true },
    ),
    // Searches a few of the keys.
    'tile-ranges': () => [0, 0],
    'tile-masks': ({ visible, pairs, recordBytes }) =>
      pairs === 0 ? [0, 0] : [2 * WORD_BYTES * pairs + recordBytes * visible, PAIR_MASK_BYTES * pairs],
  },
  tiles: {
    'tile-rasterize': ({ visible, pairs, recordBytes, layerBytes }) =>
      pairs === 0
        ? [0, layerBytes]
        : [(PAIR_MASK_BYTES + WORD_BYTES) * pairs + recordBytes * visible, layerBytes],
    // Of long lists, which are counted above.
    'tile-rest': () => [0, 0],
  },
  'quads sample': { rasterize: () => [0, 0] },
  rasterize: {
    rasterize: ({ visible, drawsQuads, recordBytes, layerBytes }) => [
      drawsQuads * (WORD_BYTES + recordBytes) * visible,
      drawsQuads * layerBytes,
    ],
  },
  upscale: { upscale: ({ layerBytes, imageBytes }) => [layerBytes, imageBytes] },
  composite: {
    composite: ({ imageBytes, imagePixels }) => [imageBytes, CANVAS_PIXEL_BYTES * imagePixels],
  },
};

/**
 * Returns the bytes that the passes of a stage must read and write at the least in `frame`, by the
 * label of their pass and the name of their stage; null for passes of other frames.
 *
 * Counts every element that a pass needs, once: a splat's whole geometry, record or coefficients
 * even where only some of their fields are used, since memory gives no less; lists and keys; each
 * pixel of a layer, written once. Counts nothing twice that caches could keep, no uniforms or
 * plans, and no blending: neither pixels that several quads cover, nor splats that several tiles
 * load. Takes no tile to end before its last splat.
 */
export function leastBytes(frame: CountedFrame): (part: string, stage: string) => PassBytes | null {
  const counts = countsOf(frame);
  return (part, stage) => {
    const rule = RULES[part]?.[stage];
    if (!rule) return null;
    const [read, written] = rule(counts);
    return { read, written };
  };
}

function countsOf({ shape, statistics, size, pixelBytes }: CountedFrame): Counts {
  const { clouds, accuracy } = shape;
  const { candidateSplats, visibleSplats, rasterizer, tilePairs } = statistics;
  const layer = layerSize(size, accuracy);
  const imagePixels = size.widthPx * size.heightPx;
  const splatsOf = ({ cloud, instanceCount }: CloudShape) => cloud.count * (instanceCount ?? 1);
  const splats = clouds.reduce((sum, each) => sum + splatsOf(each), 0);
  const mean = (wordsOf: (cloud: CloudShape) => number) =>
    clouds.reduce((sum, each) => sum + WORD_BYTES * wordsOf(each) * splatsOf(each), 0) / Math.max(1, splats);
  return {
    chunks: clouds.reduce(
      (sum, { cloud, instanceCount }) => sum + Math.ceil(cloud.count / CHUNK_SPLATS) * (instanceCount ?? 1),
      0,
    ),
    visibleChunks: Math.ceil(candidateSplats / CHUNK_SPLATS),
    candidates: candidateSplats,
    visible: visibleSplats,
    pairs: rasterizer === 'tiles' ? (tilePairs ?? 0) : 0,
    drawsQuads: Number(rasterizer === 'quads'),
    layerBytes: pixelBytes * layer.widthPx * layer.heightPx,
    imagePixels,
    imageBytes: pixelBytes * imagePixels,
    geometryBytes: mean(({ planes }) => GEOMETRY_WORDS[planes.geometryPrecision]),
    harmonicsBytes: mean(({ planes: { shPrecision }, shDegree }) => {
      // Two indices to a word.
      if (shPrecision === 'palette') return shDegree > 0 ? 0.5 : 0;
      return shWordsPerSplat(shDegree, shPrecision);
    }),
    entryBytes: clouds.reduce((sum, each) => sum + entryBytesOf(each, visibleSplats), 0),
    rangeBytes: mean(({ planes }) => (planes.geometryPrecision === 'packed' ? 2 : 0)),
    recordBytes: SPLAT_RECORDS[accuracy.recordPrecision].bytes,
    depthSort: depthSortShape(shape),
    pairSort: pairSortShape(shape),
  };
}

/** Bytes read of a cloud's SH palette: each entry once, or one per visible splat if these are fewer. */
function entryBytesOf({ cloud, planes, shDegree }: CloudShape, visible: number): number {
  const [page] = planes.pages;
  if (planes.shPrecision !== 'palette' || !page?.shRest) return 0;
  const entryWords = page.shRest.size / WORD_BYTES - Math.ceil(page.splatCount / 2);
  const entries = entryWords / shWordsPerSplat(cloud.shDegree, ENTRY_PRECISION);
  return WORD_BYTES * shWordsPerSplat(shDegree, ENTRY_PRECISION) * Math.min(visible, entries);
}
