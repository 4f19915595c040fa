import { gpuStruct } from './gpu-struct.ts';
import type { ShaderStruct } from './structs.ts';

/** Number of splats of a page to repack, and the cloud's log scales as in `Page`. */
export const RepackParameters = gpuStruct('RepackParameters', {
  logScales: 'vec2f',
  splatCount: 'u32',
  dispatchRow: 'u32',
});

/** Rows of a file that a dispatch of ingest-rows takes. */
export const IngestParameters = gpuStruct('IngestParameters', {
  /** Byte offset in a row of each value, by `ROW_SLOT`, four to an element. */
  offsets: 'array<vec4u, 15>',
  strideBytes: 'u32',
  isBigEndian: 'u32',
  /** First row among the bytes at hand, and the number of rows. */
  firstRow: 'u32',
  rowCount: 'u32',
  /** Slot of the first row in its page; a multiple of 256. */
  pageSlot: 'u32',
  /** Slot of the first row in the cloud; a multiple of 256. */
  maskRow: 'u32',
  dispatchRow: 'u32',
});

/** What ingest-settle needs to know of a page, and of the cloud. */
export const SettleParameters = gpuStruct('SettleParameters', {
  /** The cloud's origin in the file. */
  origin: 'vec3f',
  /** Step of the cloud's log scales; 0 if all are the same. */
  logScaleStep: 'f32',
  /** Smallest log scale, in steps of 2⁻¹⁹ above −40. */
  minLogScale: 'u32',
  slotCount: 'u32',
  /** Slot in the cloud of the page's first. */
  firstSlot: 'u32',
  dispatchRow: 'u32',
});

/** How ingest-keys makes sort keys of the splats of a page. */
export const MortonParameters = gpuStruct('MortonParameters', {
  /** A `MortonFrame`. */
  scale: 'vec3f',
  cellsPerUnit: 'f32',
  scaledMin: 'vec3f',
  /** 0: lower halves of the codes, in the order of slots; 1: upper halves, in a given order. */
  round: 'u32',
  /** Slots of the page in the cloud. */
  pageStart: 'u32',
  pageEnd: 'u32',
  slotCount: 'u32',
  dispatchRow: 'u32',
});

/** One word of all splats, between a page and a list of words. */
export const PermuteParameters = gpuStruct('PermuteParameters', {
  word: 'u32',
  wordsPerSplat: 'u32',
  /** Bits that are kept. */
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
  logScales: 'vec2f',
  splatCount: 'u32',
  dispatchRow: 'u32',
});

/** Structs of the stages that pack splats, which come with those. */
export const PACKING_STRUCTS: readonly ShaderStruct[] = [
  RepackParameters,
  IngestParameters,
  SettleParameters,
  MortonParameters,
  PermuteParameters,
  ChunkParameters,
];
