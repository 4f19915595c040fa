import { expect } from 'vitest';
import type { ColorTarget, RecordPrecision, SizePx } from '../data/accuracy/accuracy.ts';
import type { Camera } from '../data/camera/camera.ts';
import { type DepthConvention, depthMapping, storedDepth } from '../data/camera/depth-convention.ts';
import { binGrid } from '../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { HostDepth, TilePlan } from '../data/layout/structs.ts';
import { readTexture } from '../gpu/read-texture.ts';
import { FLOAT32_ROUNDING } from '../inspect/error-bounds.ts';
import { reachSquared } from '../reference/stacked-opacity.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import { alphaAt, OPAQUE, tilePixel } from '../stages/tiles/tiles.reference.ts';
import { splitsLists, tileRasterize, tileRest } from '../stages/tiles/tiles.ts';
import { depthTexture, readFloats } from './gpu-textures.ts';
import { type DrawnSplat, type RankedRecord, rankedRecords, shuffled } from './ranked-records.ts';
import { seededRandom } from './seeded-random.ts';
import type { TestGpu } from './test-gpu.ts';
import { maskPlace, tileUniforms } from './tile-buffers.ts';

const { BIN_PX, BIN_TILES, MASK_GROUP, TILE_PX } = SHADER_CONSTANTS;
const TILES = BIN_TILES * BIN_TILES;
const ALPHA_CUTOFF = 1 / 255;
/** No multiple of a tile's or a bin's size; 2×2 bins. */
export const SIZE = { widthPx: 75, heightPx: 69 };

/** The host's depth: its surface at each pixel, and how it stores depth. */
export interface Host {
  readonly camera: Camera;
  readonly mapping: DepthConvention['mapping'];
  readonly compare: DepthConvention['compare'];
  /** View depth of the host's surface; Infinity where it drew nothing. */
  readonly surfaceView: (xPx: number, yPx: number) => number;
  readonly isExactOrder: boolean;
  readonly hasDepthLayer: boolean;
}

/** A scene to be drawn by tiles. */
export interface Scene {
  /** Nearest first. */
  readonly ranked: readonly DrawnSplat[];
  readonly size?: SizePx;
  readonly recordPrecision?: RecordPrecision;
  readonly colorTarget?: ColorTarget;
  readonly host?: Host;
  readonly isStacked?: boolean;
  /** Whether a bin lists a splat; default most bins list most splats. */
  readonly isListed?: (bin: number, rank: number) => boolean;
  /** Bins are 2^binShift times as wide and high: there are lists of the first ones alone. Default 0. */
  readonly binShift?: number;
  /** Whether a pair may touch a tile of its bin; default half of the tiles. */
  readonly isMasked?: (pair: number, tile: number) => boolean;
}

/** A scene's pairs: by bin, front to back. Bins share a list: most begin inside words of masks. */
function pairsOf({ ranked, size = SIZE, isListed, isMasked }: Scene) {
  const { binColumns, binRows } = binGrid(size.widthPx, size.heightPx);
  const random = seededRandom(77);
  const ranks: number[] = [];
  const binStarts = [0];
  for (let bin = 0; bin < binColumns * binRows; bin++) {
    for (let rank = 0; rank < ranked.length; rank++)
      if (isListed ? isListed(bin, rank) : random() < 0.9) ranks.push(rank);
    binStarts.push(ranks.length);
  }
  // Bits of pairs that other bins own, and of none, are set as well.
  const masks = new Uint32Array(Math.ceil(ranks.length / MASK_GROUP) * ((TILES * MASK_GROUP) / 32));
  for (let i = 0; i < masks.length; i++) masks[i] = 2 ** 32 * random();
  if (isMasked)
    for (let pair = 0; pair < ranks.length; pair++)
      for (let tile = 0; tile < TILES; tile++) {
        const [word, bit] = maskPlace(pair, tile);
        masks[word] = (masks[word] & ~(1 << bit)) | (Number(isMasked(pair, tile)) << bit);
      }
  return { ranks, binStarts, masks, binColumns };
}

function makeTarget(device: GPUDevice, format: GPUTextureFormat, { widthPx, heightPx }: SizePx): GPUTexture {
  const usage = GPUTextureUsage.STORAGE_BINDING | GPUTextureUsage.COPY_SRC;
  return device.createTexture({ size: [widthPx, heightPx], format, usage });
}

/** How tiles are blended: by threads that each work alone, or together, with room for so many fronts. */
export interface Threads {
  readonly isNarrow: boolean;
  readonly fronts: number;
}

/** Draws a scene by the GPU. */
export async function drawTiles(
  gpu: TestGpu,
  scene: Scene,
  { isNarrow, fronts }: Threads,
  drawing = gpu.pipelines,
) {
  const { ranked, size = SIZE, recordPrecision = 'f32', colorTarget = 'rgba32float', host } = scene;
  const { binShift = 0 } = scene;
  const packed = rankedRecords(ranked, recordPrecision);
  const pairs = pairsOf(scene);
  const binCount = pairs.binStarts.length - 1;
  const counts = { neededPairs: 0, pairCount: pairs.ranks.length, fits: 1, visibleCount: ranked.length };
  const dispatchRow = 50;
  const layer = makeTarget(gpu.device, colorTarget, size);
  const depthLayer = makeTarget(gpu.device, 'r32float', size);
  const isOrthographic = host?.camera.projectionMatrix[11] === 0;
  const variant = {
    recordPrecision,
    colorTarget,
    depth: host
      ? {
          ...host,
          isOrthographic,
          isTested: true,
          layerFormat: host.hasDepthLayer ? ('r32float' as const) : null,
        }
      : null,
    isExactOrder: host?.isExactOrder ?? true,
    isNarrow,
    isStacked: scene.isStacked,
  };
  const bindings = {
    ...tileUniforms(gpu, { size, alphaCutoff: ALPHA_CUTOFF, dispatchRow }),
    tilePlan: gpu.storage(new Uint32Array(TilePlan.pack({ ...counts, binShift }))),
    binStarts: gpu.storage(pairs.binStarts),
    binOrder: gpu.storage(shuffled(binCount)),
    tileMasks: gpu.storage(pairs.masks),
    sortedRecords: gpu.storage(pairs.ranks.map((rank) => packed.places[rank])),
    records: gpu.storage(packed.words),
    layer: layer.createView(),
    longTiles: gpu.storage([], 8 + 8 * binCount * TILES),
    // A part of a front is never used.
    frontPixels: gpu.storage([], 16 * TILE_PX ** 2 * Math.max(0.5, fronts)),
    ...(host && {
      hostDepth: gpu.uniform(HostDepth.pack(depthMapping(host.camera, host.mapping))),
      testedDepth: depthTexture(gpu.device, {
        ...size,
        samples: 1,
        values: hostDepths(host, size),
      }).createView(),
      depthLayer: depthLayer.createView(),
    }),
  };
  // Workgroups behind the last tile must do nothing.
  const workgroups = dispatchSize(binCount * TILES + 3, dispatchRow);
  let longTileCount = 0;
  // Hosts draw a frame again and again.
  for (let time = 0; time < (splitsLists(variant) ? 2 : 1); time++) {
    await gpu.run(tileRasterize(variant), bindings, workgroups, drawing);
    [longTileCount] = await gpu.read(bindings.longTiles);
    if (splitsLists(variant)) await gpu.run(tileRest(variant), bindings, [2, 1, 1], drawing);
  }
  const { data } = await readTexture(gpu.device, layer);
  const depths = host?.hasDepthLayer ? await readFloats(gpu.device, depthLayer) : null;
  layer.destroy();
  depthLayer.destroy();
  return { data, depths, records: packed.records, pairs, longTileCount };
}

function ndcOf(xPx: number, yPx: number, { widthPx, heightPx }: SizePx): readonly [number, number] {
  return [(2 * (xPx + 0.5)) / widthPx - 1, 1 - (2 * (yPx + 0.5)) / heightPx];
}

/** Depths in the host's buffer. */
function hostDepths(host: Host, size: SizePx): number[] {
  const cleared = host.compare === 'less-equal' ? 1 : 0;
  return Array.from({ length: size.widthPx * size.heightPx }, (_, i) => {
    const [x, y] = [i % size.widthPx, Math.floor(i / size.widthPx)];
    const view = host.surfaceView(x, y);
    if (view === Number.POSITIVE_INFINITY) return cleared;
    // The host draws no surface in front of its near plane or behind its far plane.
    return Math.min(1, Math.max(0, storedDepth(view, host.camera, host.mapping, ndcOf(x, y, size))));
  });
}

/** Whether neither the host's surface nor its clipping hides a splat at a pixel. */
function isShown(
  depthView: number,
  host: Host,
  xPx: number,
  yPx: number,
  size: SizePx,
  surface: number,
): boolean {
  const stored = storedDepth(depthView, host.camera, host.mapping, ndcOf(xPx, yPx, size));
  if (stored < 0 || stored > 1) return false;
  return host.compare === 'less-equal' ? stored <= surface : stored >= surface;
}

/**
 * Bound of the error of a value blended from `records` at a pixel, if each has a value of at most
 * 1. A splat's alpha moves the value by at most the light that reaches it. It errs by some
 * roundings of the local coordinates, |d exp(−p²)/dp| ≤ 0.86, or |dα/dp| ≤ 2p of a stack, and of
 * the exponential; near the cutoff, rounding decides whether the splat is drawn.
 */
function errorBound(records: readonly RankedRecord[], x: number, y: number): number {
  let [light, error] = [1, 0];
  for (const record of records) {
    const alpha = alphaAt(record, x, y);
    const [dx, dy] = [x + 0.5 - record.centerPx[0], y + 0.5 - record.centerPx[1]];
    const localError = (16 * FLOAT32_ROUNDING * (Math.abs(dx) + Math.abs(dy))) / record.minorLengthPx;
    const [opacity, isMerged] = [record.color[3], record.color[3] > 1];
    const slope = isMerged ? 2 * Math.sqrt(reachSquared(opacity, ALPHA_CUTOFF)) : 0.86 * opacity;
    const alphaError = slope * localError + (isMerged ? 128 : 32) * FLOAT32_ROUNDING;
    const isDoubtful = Math.abs(alpha - ALPHA_CUTOFF) <= alphaError;
    error += light * (alphaError + (isDoubtful ? ALPHA_CUTOFF : 0));
    if (alpha >= ALPHA_CUTOFF) light *= 1 - alpha;
    if (light < OPAQUE / 2) break;
  }
  // Reference and shader end pixels at different splats: less than OPAQUE of the light passes both.
  return error + (light < 2 * OPAQUE ? OPAQUE : 0);
}

/**
 * View depths of the records that may make a pixel more than half covered, if opacities err by up
 * to `error`.
 */
function possibleMedians(
  records: readonly RankedRecord[],
  [x, y]: readonly [number, number],
  error: number,
): number[] {
  const possible: number[] = [];
  let light = 1;
  for (const record of records) {
    const alpha = alphaAt(record, x, y);
    if (alpha < ALPHA_CUTOFF) continue;
    const before = light;
    light *= 1 - alpha;
    if (before > 0.5 - error && light <= 0.5 + error) possible.push(record.depthView);
  }
  return possible;
}

/** Rounding of a colour in a target's format. */
function formatError(colorTarget: ColorTarget, value: number): number {
  if (colorTarget === 'rgba8unorm') return 0.501 / 255;
  return colorTarget === 'rgba16float' ? Math.max(Math.abs(value) * 2 ** -10, 2 ** -24) : 0;
}

/** Compares every pixel of both kinds of threads with the reference; returns statistics. */
export async function checkTiles(gpu: TestGpu, scene: Scene, drawing = gpu.pipelines) {
  const { size = SIZE, colorTarget = 'rgba32float', host, binShift = 0 } = scene;
  const { widthPx, heightPx } = size;
  const together = await drawTiles(gpu, scene, { isNarrow: false, fronts: 100 }, drawing);
  const alone = await drawTiles(gpu, scene, { isNarrow: true, fronts: 0 }, drawing);
  const drawn = Object.entries({ together, alone });
  const { records, pairs } = together;
  const surfaces = host && Float32Array.from(hostDepths(host, size));
  const brightest = Math.max(1, ...records.flatMap(({ color }) => color.slice(0, 3)));
  const farthest = Math.max(...records.map(({ depthView }) => depthView));
  const listedRecords = (bin: number, tile: number) => {
    const listed: RankedRecord[] = [];
    for (let pair = pairs.binStarts[bin]; pair < pairs.binStarts[bin + 1]; pair++) {
      const [word, bit] = maskPlace(pair, tile);
      if ((pairs.masks[word] >>> bit) & 1) listed.push(records[pairs.ranks[pair]]);
    }
    return listed;
  };
  const tiles: RankedRecord[][] = [];
  let [covered, hidden, ended, medians] = [0, 0, 0, 0];
  for (let y = 0; y < heightPx; y++) {
    for (let x = 0; x < widthPx; x++) {
      const pixel = y * widthPx + x;
      const [binPx, blockPx] = [BIN_PX * 2 ** binShift, TILE_PX * 2 ** binShift];
      const columns = Math.ceil(pairs.binColumns / 2 ** binShift);
      const bin = Math.floor(y / binPx) * columns + Math.floor(x / binPx);
      const tile = Math.floor((y % binPx) / blockPx) * BIN_TILES + Math.floor((x % binPx) / blockPx);
      tiles[bin * TILES + tile] ??= listedRecords(bin, tile);
      const listed = tiles[bin * TILES + tile];
      const shown = host
        ? listed.filter(({ depthView }) => isShown(depthView, host, x, y, size, surfaces![pixel]))
        : listed;
      const reference = tilePixel(shown, [x, y], ALPHA_CUTOFF);
      const error = errorBound(shown, x, y);
      for (const [threads, { data, depths }] of drawn) {
        const place = () => `column ${x}, row ${y}, by threads ${threads}`;
        for (let channel = 0; channel < 4; channel++) {
          const value = reference.rgba[channel];
          const expected = colorTarget === 'rgba8unorm' ? Math.min(1, value) : value;
          const bound = (channel === 3 ? 1 : brightest) * error + formatError(colorTarget, expected);
          const got = data[4 * pixel + channel];
          if (!(Math.abs(got - expected) <= bound))
            expect.fail(`${place()}, channel ${channel}: got ${got}, expected ${expected} ± ${bound}`);
        }
        // A cover of less than half a pixel has no median.
        if (depths && reference.rgba[3] > 0.5 + error) {
          const bound = 2 * farthest * error;
          const possible = possibleMedians(shown, [x, y], error).map(
            (depthView) => depthView * reference.rgba[3],
          );
          if (!possible.some((expected) => Math.abs(depths[pixel] - expected) <= bound))
            expect.fail(`${place()}: depth ${depths[pixel]}, expected ${possible} ± ${bound}`);
          medians++;
        }
      }
      if (reference.rgba[3] > 0) covered++;
      if (shown.length < listed.length) hidden++;
      if (reference.tested < shown.length) ended++;
    }
  }
  return { covered, hidden, ended, medians, data: together.data, longTileCount: together.longTileCount };
}

/**
 * Splats of moderate sizes in and around a layer, nearest first: depths of 0.503…60 in 24 steps,
 * far from the host's surfaces.
 */
export function splats(count: number, { widthPx, heightPx }: SizePx = SIZE, mostOpacity = 1): DrawnSplat[] {
  const random = seededRandom(count);
  return Array.from({ length: count }, (_, i) => {
    const minorLengthPx = 1 * 15 ** random();
    return {
      centerPx: [(1.2 * random() - 0.1) * widthPx, (1.2 * random() - 0.1) * heightPx],
      minorLengthPx,
      majorLengthPx: minorLengthPx * 6 ** random(),
      angle: Math.PI * random(),
      opacity: mostOpacity * random(),
      rgb: [random(), random(), 0.5],
      depthView: 0.503 * 120 ** (Math.floor((24 * i) / count) / 24),
    };
  });
}

/** A splat that is nearly as opaque everywhere in the layer as in its centre. */
export const veil = (opacity: number, changes: Partial<DrawnSplat> = {}): DrawnSplat => ({
  centerPx: [30, 30],
  majorLengthPx: 1e5,
  minorLengthPx: 1e5,
  angle: 0,
  opacity,
  ...changes,
});

/** Of every pair. */
export const always = () => true;
