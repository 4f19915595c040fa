import { gpuStruct } from './gpu-struct.ts';
import type { ShaderStruct } from './structs.ts';

/** Number of splats of a page to repack. */
export const RepackParameters = gpuStruct('RepackParameters', {
  splatCount: 'u32',
  dispatchRow: 'u32',
});

/** Splats of a page to blend; begins as RepackParameters does. */
export const MorphParameters = gpuStruct('MorphParameters', {
  ...RepackParameters.fields,
  /** Share of the second page, 0…1. */
  amount: 'f32',
});

/** Splats of a page to move with joints; begins as RepackParameters does. */
export const SkinParameters = gpuStruct('SkinParameters', RepackParameters.fields);

/** Rows of a file that a dispatch of ingest-rows takes. */
export const IngestParameters = gpuStruct('IngestParameters', {
  /** Byte offset in a row of each value, by `ROW_SLOT`, four to an element. */
  offsets: 'array<vec4u, 15>',
  /** `ByteValues`: scale, offset, least, most. */
  byteValues: 'vec4f',
  strideBytes: 'u32',
  isBigEndian: 'u32',
  /** Offset of the first row's byte harmonics, and their stride. */
  harmonicsByte: 'u32',
  harmonicsStrideBytes: 'u32',
  /** First row among the bytes at hand, and the number of rows. */
  firstRow: 'u32',
  rowCount: 'u32',
  /** Slot of the first row in its page; a multiple of 256. */
  pageSlot: 'u32',
  /** Slot of the first row in the cloud; a multiple of 256. */
  maskRow: 'u32',
  dispatchRow: 'u32',
});

/** How ingest-keys makes sort keys of the splats of a page. */
export const MortonParameters = gpuStruct('MortonParameters', {
  /** The first five members are a `MortonFrame`. */
  min: 'vec3f',
  max: 'vec3f',
  scale: 'vec3f',
  cellsPerUnit: 'f32',
  scaledMin: 'vec3f',
  /**
   * Round of the radix sort, 0…5, each by eight bits of the Morton codes, lowest first. Round 0 reads
   * splats in the order of slots, later rounds in the order of the round before.
   */
  round: 'u32',
  /** Origin of the cloud, in coordinates of its file. */
  origin: 'vec3f',
  /** Slots of the page in the cloud. */
  pageStart: 'u32',
  pageEnd: 'u32',
  slotCount: 'u32',
  dispatchRow: 'u32',
});

/** Successive words of all splats, between a page and a list of words. */
export const PermuteParameters = gpuStruct('PermuteParameters', {
  /** The first, and the number of them. */
  word: 'u32',
  words: 'u32',
  wordsPerSplat: 'u32',
  /** Bits of the last that are kept. */
  mask: 'u32',
  /** Splats of the page in the cloud. */
  pageStart: 'u32',
  pageEnd: 'u32',
  /** Length of the list. */
  count: 'u32',
  dispatchRow: 'u32',
});

/** Splats of a page whose chunks' bounds are taken. */
export const ChunkParameters = gpuStruct('ChunkParameters', {
  /** The cloud's origin in the file. */
  origin: 'vec3f',
  /** The page's first splat in the cloud. */
  firstSplat: 'u32',
  splatCount: 'u32',
  dispatchRow: 'u32',
});

/** Splats of a page that pack-buffers packs from the application's buffers. */
export const BufferParameters = gpuStruct('BufferParameters', {
  /** Splats outside are not drawn. */
  boundsMin: 'vec3f',
  splatCount: 'u32',
  boundsMax: 'vec3f',
  dispatchRow: 'u32',
  /** First word of the page, and words from splat to splat: positions, scales, rotations, opacities, colours. */
  columns: 'array<vec4u, 5>',
});

/** Structs of the stages that pack splats. */
export const PACKING_STRUCTS: readonly ShaderStruct[] = [
  RepackParameters,
  MorphParameters,
  SkinParameters,
  IngestParameters,
  MortonParameters,
  PermuteParameters,
  ChunkParameters,
  BufferParameters,
];
