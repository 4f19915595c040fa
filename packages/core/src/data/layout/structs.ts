import { type GpuStruct, gpuStruct } from './gpu-struct.ts';

/** The camera and the image, as the per-splat stages see them. Units as in `Projection`. */
export const View = gpuStruct('View', {
  sizePx: 'vec2f',
  focalPx: 'vec2f',
  centerPx: 'vec2f',
  clampX: 'vec2f',
  clampY: 'vec2f',
  near: 'f32',
  far: 'f32',
  alphaCutoff: 'f32',
  /** Workgroups per row of a dispatch. */
  dispatchRow: 'u32',
});

/** One page (the part of a cloud's planes that fits one binding) as one camera sees it. */
export const Page = gpuStruct('Page', {
  /** Cloud space to view space, about the cloud's origin. */
  linear: 'mat3x3f',
  /** The cloud's origin in view space. */
  translation: 'vec3f',
  /** Variance that is added to both screen axes of every splat, px². */
  dilationPx2: 'f32',
  /** The camera in cloud space, about the cloud's origin. */
  camera: 'vec3f',
  /** 1 if viewing directions start at the camera, 0 if they are all `direction`. */
  cameraWeight: 'f32',
  /** From lines of sight in cloud space to viewing directions: see `CloudView.sight`. */
  sight: 'mat3x3f',
  direction: 'vec3f',
  /** First of the thresholds of its cells, where a cut through levels is drawn. */
  cellStart: 'u32',
  /** Left, right, bottom, top, near, far in cloud space: in if dot(xyz, point) + w ≥ 0. */
  frustum: 'array<vec4f, 6>',
  /** x: how far a splat reaches across the side, per unit of its largest standard deviation. */
  frustumReach: 'array<vec4f, 6>',
  /** Index of this page in the frame. */
  index: 'u32',
  /** First chunk, counting through all pages of the frame. */
  chunkStart: 'u32',
  chunkCount: 'u32',
  splatCount: 'u32',
});

/** A chunk's bounds: of centres, about the cloud's origin, and of log scales, as 65535 steps. */
export const Chunk = gpuStruct('Chunk', {
  minPosition: 'vec3f',
  minLogScale: 'f32',
  maxPosition: 'vec3f',
  /** 0 where all log scales are the same. Packed log scales are unorm16 of these. */
  logScaleStep: 'f32',
});

/** Results of culling for one page, computed on the GPU in each frame. */
export const PagePlan = gpuStruct('PagePlan', {
  chunkStart: 'u32',
  chunkEnd: 'u32',
  /** First visible chunk of the page in the list of all visible chunks, and the number of them. */
  slotStart: 'u32',
  slotCount: 'u32',
  /** First visible splat of the page in the list of all visible splats, and the number of them. */
  visibleStart: 'u32',
  visibleCount: 'u32',
});

/** Sizes of a frame that are known on the host. */
export const CullParameters = gpuStruct('CullParameters', {
  chunkCount: 'u32',
  pageCount: 'u32',
  /** Most visible splats; further ones, in storage order, are left out. */
  visibleCapacity: 'u32',
  dispatchRow: 'u32',
});

/** One pass of the sort. */
export const SortParameters = gpuStruct('SortParameters', {
  digitShift: 'u32',
  capacity: 'u32',
  dispatchRow: 'u32',
  /** 1 where the payload of each key is its own index, 0 where payloads are read. */
  makesPayloads: 'u32',
  /** 1 where keys are written, 0 where only payloads are. */
  writesKeys: 'u32',
  /** Threads of sort-scan per digit. */
  scanLanes: 'u32',
});

/** Sizes of a sort, computed on the GPU. */
export const SortPlan = gpuStruct('SortPlan', { keyCount: 'u32', blockCount: 'u32' });

/** How the layer is divided for the tile stages. */
export const TileGrid = gpuStruct('TileGrid', {
  sizePx: 'vec2u',
  binColumns: 'u32',
  binRows: 'u32',
  /** Number of pairs that there is room for. */
  pairCapacity: 'u32',
  /** Number of the tile that the first workgroup of tile-rasterize draws. */
  firstTile: 'u32',
});

/** Number of pairs of a frame, computed on the GPU. */
export const TilePlan = gpuStruct('TilePlan', {
  /** All pairs of the visible splats, whether they fit or not. */
  neededPairs: 'u32',
  /** Pairs to draw, with bins of that size; none if they do not fit. */
  pairCount: 'u32',
  /** 1 if the tiles draw this frame; 0 if the quads do. */
  fits: 'u32',
  visibleCount: 'u32',
  /** Bins are 2^binShift times as wide and high as they are where all pairs fit. */
  binShift: 'u32',
});

/** A visible splat as it is drawn; lengths in pixels, y down. Axes at √2 deviations. 32 bytes. */
export const SplatRecord = gpuStruct('SplatRecord', {
  centerPx: 'vec2f',
  majorPx: 'vec2f',
  minorLengthPx: 'f32',
  depthView: 'f32',
  /** r, g, b and opacity as four float16. */
  color: 'vec2u',
});

/** The record at `recordPrecision: 'f32'`. 48 bytes. */
export const SplatRecordF32 = gpuStruct('SplatRecord', {
  centerPx: 'vec2f',
  majorPx: 'vec2f',
  minorLengthPx: 'f32',
  depthView: 'f32',
  color: 'vec4f',
});

/** The record at `recordPrecision: 'paper'`. 24 bytes. */
export const SplatRecordPaper = gpuStruct('SplatRecord', {
  centerPx: 'vec2f',
  /** Two float16, none beyond ±65504. */
  majorPx: 'u32',
  minorPx: 'u32',
  /** r, g, b and opacity as four unorm8, which clamp a merged splat's opacity to 1. */
  color: 'u32',
  depthView: 'f32',
});

/** Records by their precision. */
export const SPLAT_RECORDS = { f32: SplatRecordF32, f16: SplatRecord, paper: SplatRecordPaper };

/** How the host renderer stores depth: see `DepthMapping`. */
export const HostDepth = gpuStruct('HostDepth', { slope: 'vec2f', offset: 'f32', factor: 'f32' });

/** Where the splats' image lies in the host's textures. */
export const HostViewport = gpuStruct('HostViewport', {
  /** Top left of the image; modulo 2³², since it may lie outside. */
  colorOriginPx: 'vec2u',
  depthOriginPx: 'vec2u',
  /** Size of the image, per axis, as a multiple of the size of the layer of splats. */
  pxPerLayerPx: 'vec2f',
  /** 1: the image has the host's colours where there is no splat; 0: nothing. */
  hasHost: 'u32',
});

/** Width and height of the layer that splats are blended in, as fractions of the image's. */
export const UpscaleParameters = gpuStruct('UpscaleParameters', { layerPerPx: 'vec2f' });

export const CompositeParameters = gpuStruct('CompositeParameters', { background: 'vec3f' });

/** A struct as shaders see it. */
export type ShaderStruct = Pick<GpuStruct<never>, 'name' | 'wgsl'>;

/** Structs that any shader may import by their names (`import layout::View;`). */
export const SHADER_STRUCTS: readonly ShaderStruct[] = [
  View,
  Page,
  Chunk,
  PagePlan,
  CullParameters,
  SortParameters,
  SortPlan,
  CompositeParameters,
  HostDepth,
  HostViewport,
  UpscaleParameters,
  TileGrid,
  TilePlan,
];
