import type { SizePx } from '../data/accuracy/accuracy.ts';
import { type BinGrid, binGrid } from '../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { TileGrid } from '../data/layout/structs.ts';
import type { EllipseRecord, SplatEllipse } from '../reference/splat-ellipse.ts';
import { splatEllipse } from '../reference/splat-ellipse.ts';
import { touchedBins } from '../stages/tiles/tiles.reference.ts';
import { packFlatView } from './flat-view.ts';
import type { DrawnSplat } from './ranked-records.ts';
import type { TestGpu } from './test-gpu.ts';

interface TileUniforms {
  readonly size: SizePx;
  readonly alphaCutoff: number;
  /** Workgroups per row of a dispatch; default so many that there is one row. */
  readonly dispatchRow?: number;
  readonly pairCapacity?: number;
  readonly firstTile?: number;
}

/** The uniforms of the tile stages: the fields of `View` that they read, and the layer's bins. */
export function tileUniforms(gpu: TestGpu, options: TileUniforms) {
  const { size, alphaCutoff, dispatchRow = 65_535, pairCapacity = 2 ** 24, firstTile = 0 } = options;
  const { widthPx, heightPx } = size;
  const view = packFlatView({ size, alphaCutoff, dispatchRow });
  const sizePx = [widthPx, heightPx] as const;
  const grid = TileGrid.pack({ sizePx, ...binGrid(widthPx, heightPx), pairCapacity, firstTile });
  return { view: gpu.uniform(view), grid: gpu.uniform(grid) };
}

/** Upper bound of the shader's widening of an ellipse, px. */
export function mostSlackPx({ centerPx, extentPx }: SplatEllipse): number {
  const magnitude = [...centerPx, ...extentPx].reduce((sum, value) => sum + Math.abs(value), 0);
  return 0.05 + 1e-5 * magnitude;
}

/**
 * Bins that the GPU must find (`least`), and bins that it may find (`most`).
 *
 * @param shift bins are 2^shift times as wide and high as the grid's; default 0.
 */
export function binsOf(record: EllipseRecord, grid: BinGrid, alphaCutoff: number, shift = 0) {
  const ellipse = splatEllipse(record, alphaCutoff);
  const least = touchedBins(ellipse, grid, 0, shift);
  return { least, most: ellipse ? touchedBins(ellipse, grid, mostSlackPx(ellipse), shift) : least };
}

/** Whether the record has the same bins with and without rounding and widening. */
export function hasClearBins(record: EllipseRecord, grid: BinGrid, alphaCutoff: number, shift = 0): boolean {
  const { least, most } = binsOf(record, grid, alphaCutoff, shift);
  return least.length === most.length;
}

/** A splat in or around the layer, of any slimness, fainter than usual cutoffs one time in four. */
export function anySplat(random: () => number, { widthPx, heightPx }: SizePx): DrawnSplat {
  const minorLengthPx = 0.78 * 40 ** random();
  return {
    centerPx: [(1.6 * random() - 0.3) * widthPx, (1.6 * random() - 0.3) * heightPx],
    minorLengthPx,
    majorLengthPx: minorLengthPx * 60 ** (random() * random()),
    angle: Math.PI * random(),
    opacity: random() < 0.25 ? 0.002 * random() : random(),
  };
}

/** Opacities of merged splats. */
export const MERGED_OPACITIES = [1.0001, 1.5, 3, 40, 1000] as const;

/** `splat`, every other one merged, by its place in a list. */
export function merged(splat: DrawnSplat, i: number): DrawnSplat {
  return i % 2 ? splat : { ...splat, opacity: MERGED_OPACITIES[(i / 2) % MERGED_OPACITIES.length] };
}

const { BIN_TILES, MASK_GROUP } = SHADER_CONSTANTS;
const TILES = BIN_TILES * BIN_TILES;
const GROUP_WORDS = MASK_GROUP / 32;

/** The word and the bit of the masks that say whether a pair may touch a tile of its bin. */
export function maskPlace(pair: number, tile: number): readonly [word: number, bit: number] {
  const inGroup = pair % MASK_GROUP;
  const word = (Math.floor(pair / MASK_GROUP) * TILES + tile) * GROUP_WORDS + Math.floor(inGroup / 32);
  return [word, inGroup % 32];
}

/** Tiles that the masks name for a pair, row by row. */
export function tilesOfPair(masks: Uint32Array, pair: number): number[] {
  return Array.from({ length: TILES }, (_, tile) => tile).filter((tile) => {
    const [word, bit] = maskPlace(pair, tile);
    return (masks[word] >>> bit) & 1;
  });
}
