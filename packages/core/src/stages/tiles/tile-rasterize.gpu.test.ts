// Proves: every pixel as the reference's: records, targets, the depth of hosts.
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import type { ColorTarget, RecordPrecision, SizePx } from '../../data/accuracy/accuracy.ts';
import {
  type Camera,
  cameraFromMatrices,
  orthographicCamera,
  perspectiveCamera,
} from '../../data/camera/camera.ts';
import { type DepthConvention, depthMapping, storedDepth } from '../../data/camera/depth-convention.ts';
import { binGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { HostDepth, TilePlan } from '../../data/layout/structs.ts';
import type { Pipelines } from '../../gpu/pipelines.ts';
import { readTexture } from '../../gpu/read-texture.ts';
import { FLOAT32_ROUNDING } from '../../inspect/error-bounds.ts';
import { reachSquared } from '../../reference/stacked-opacity.ts';
import { depthTexture, readFloats } from '../../testing/gpu-textures.ts';
import { type DrawnSplat, type RankedRecord, rankedRecords, shuffled } from '../../testing/ranked-records.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { MERGED_OPACITIES, maskPlace, merged, tileUniforms } from '../../testing/tile-buffers.ts';
import { withClipDepth } from '../../testing/with-clip-depth.ts';
import { dispatchSize } from '../dispatch.ts';
import { alphaAt, OPAQUE, tilePixel } from './tiles.reference.ts';
import { splitsLists, TILE_THREADS, tileRasterize, tileRest } from './tiles.ts';

const { BIN_PX, BIN_TILES, MASK_GROUP, TILE_PX } = SHADER_CONSTANTS;
const TILES = BIN_TILES * BIN_TILES;
const ALPHA_CUTOFF = 1 / 255;
/** No multiple of a tile's or a bin's size; 2×2 bins. */
const SIZE = { widthPx: 75, heightPx: 69 };

const gpu = testGpu();

/** The host's depth: its surface at each pixel, and how it stores depth. */
interface Host {
  readonly camera: Camera;
  readonly mapping: DepthConvention['mapping'];
  readonly compare: DepthConvention['compare'];
  /** View depth of the host's surface; Infinity where it drew nothing. */
  readonly surfaceView: (xPx: number, yPx: number) => number;
  readonly isExactOrder: boolean;
  readonly hasDepthLayer: boolean;
}

interface Scene {
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

function makeTarget(format: GPUTextureFormat, { widthPx, heightPx }: SizePx): GPUTexture {
  const usage = GPUTextureUsage.STORAGE_BINDING | GPUTextureUsage.COPY_SRC;
  return gpu.device.createTexture({ size: [widthPx, heightPx], format, usage });
}

/** How tiles are blended: by threads that each work alone, or together, with room for so many fronts. */
interface Threads {
  readonly isNarrow: boolean;
  readonly fronts: number;
}

/** Draws a scene by the GPU. */
async function drawOnGpu(scene: Scene, drawing: Pipelines, { isNarrow, fronts }: Threads) {
  const { ranked, size = SIZE, recordPrecision = 'f32', colorTarget = 'rgba32float', host } = scene;
  const { binShift = 0 } = scene;
  const packed = rankedRecords(ranked, recordPrecision);
  const pairs = pairsOf(scene);
  const binCount = pairs.binStarts.length - 1;
  const counts = { neededPairs: 0, pairCount: pairs.ranks.length, fits: 1, visibleCount: ranked.length };
  const dispatchRow = 50;
  const layer = makeTarget(colorTarget, size);
  const depthLayer = makeTarget('r32float', size);
  const isOrthographic = host?.camera.projectionMatrix[11] === 0;
  const variant = {
    recordPrecision,
    colorTarget,
    depth: host
      ? { ...host, isOrthographic, layerFormat: host.hasDepthLayer ? ('r32float' as const) : null }
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
async function check(scene: Scene, drawing = gpu.pipelines) {
  const { size = SIZE, colorTarget = 'rgba32float', host, binShift = 0 } = scene;
  const { widthPx, heightPx } = size;
  const together = await drawOnGpu(scene, drawing, { isNarrow: false, fronts: 100 });
  const alone = await drawOnGpu(scene, drawing, { isNarrow: true, fronts: 0 });
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
function splats(count: number, { widthPx, heightPx }: SizePx = SIZE, mostOpacity = 1): DrawnSplat[] {
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
const veil = (opacity: number, changes: Partial<DrawnSplat> = {}): DrawnSplat => ({
  centerPx: [30, 30],
  majorLengthPx: 1e5,
  minorLengthPx: 1e5,
  angle: 0,
  opacity,
  ...changes,
});

const always = () => true;

describe('tile-rasterize', () => {
  for (const recordPrecision of ['f32', 'f16', 'paper'] as const) {
    for (const colorTarget of ['rgba32float', 'rgba16float', 'rgba8unorm'] as const) {
      gpuTest(`${recordPrecision} records in ${colorTarget}: every pixel as the reference`, async () => {
        const { covered } = await check({ ranked: splats(150), recordPrecision, colorTarget });
        expect(covered).toBeGreaterThan(0.9 * SIZE.widthPx * SIZE.heightPx);
      });
    }
  }

  for (const recordPrecision of ['f32', 'f16', 'paper'] as const) {
    gpuTest(
      `${recordPrecision} records of merged splats among others: every pixel as the reference`,
      async () => {
        // Few enough that the tiles do not end.
        const sparse = { ranked: splats(24).map(merged), recordPrecision, isStacked: true };
        expect((await check(sparse)).covered).toBeGreaterThan(2000);
        await check({ ranked: splats(150).map(merged), recordPrecision, isStacked: true });
        const needles = MERGED_OPACITIES.map((opacity) =>
          veil(opacity, { minorLengthPx: 0.8, angle: opacity }),
        );
        await check({ ranked: needles, recordPrecision, isStacked: true });
      },
    );
  }

  gpuTest('layers of any size, down to a pixel', async () => {
    for (const [widthPx, heightPx] of [
      [1, 1],
      [64, 64],
      [65, 3],
      [9, 130],
      [8, 8],
    ]) {
      const size = { widthPx, heightPx };
      const { covered } = await check({ ranked: splats(60, size), size });
      expect(covered).toBeGreaterThan(0);
    }
  });

  gpuTest('more pairs per bin than one window of masks', async () => {
    expect(2500).toBeGreaterThan(2 * 32 * TILE_THREADS);
    const ranked = splats(2500, SIZE, 0.03);
    const listedIn = (bins: readonly number[]) => (bin: number) => bins.includes(bin);
    const { covered, ended } = await check({ ranked, isListed: listedIn([0, 3]) });
    expect(covered).toBeGreaterThan(4000);
    expect(ended).toBe(0);
    // Long runs of empty words, and single bits at the ends of words.
    const isMasked = (pair: number, tile: number) => pair % 512 === tile || (pair * tile) % 1031 === 31;
    await check({ ranked: splats(2400, SIZE, 0.3), isListed: listedIn([1, 2]), isMasked });
  });

  /** Small, as every pixel takes the reference as long as its tile's list. */
  const LONG_SIZE = { widthPx: 17, heightPx: 8 };

  gpuTest('long lists, with room for the fronts of all, some or none of the tiles', async () => {
    // Sparse, dense at first only, or dense: none ends.
    const scene = {
      ranked: splats(14_000, LONG_SIZE, 0.002),
      size: LONG_SIZE,
      isListed: always,
      isMasked: (pair: number, tile: number) => [pair % 3 === 0, pair % 9000 < 3000, true][tile % 3],
    };
    const { longTileCount, ended, data } = await check(scene);
    expect(longTileCount).toBe(3);
    expect(ended).toBe(0);
    for (const fronts of [0, 1]) {
      const drawn = await drawOnGpu(scene, gpu.pipelines, { isNarrow: false, fronts });
      expect(drawn.data).toEqual(data);
    }
  });

  gpuTest('long lists whose pixels end in their front, behind it, and late', async () => {
    const faint = splats(11_000, LONG_SIZE, 0.002);
    const pixels = LONG_SIZE.widthPx * LONG_SIZE.heightPx;
    const endedWith = async (rank: number, walls: readonly DrawnSplat[]) => {
      const ranked = faint.toSpliced(rank, walls.length, ...walls);
      return (await check({ ranked, size: LONG_SIZE, isListed: always, isMasked: always })).ended;
    };
    for (const rank of [500, 3000, 10_000])
      expect(await endedWith(rank, Array(4).fill(veil(1)))).toBe(pixels);
    // Ends only by all teams of threads together.
    const spread = Array.from({ length: 7000 }, (_, i) => veil(i % 1000 === 500 ? 0.9 : 0.001));
    expect(await endedWith(3000, spread)).toBe(pixels);
    expect(await endedWith(3000, [veil(0.5)])).toBe(0);
  });

  gpuTest('bins without pairs, and tiles without any', async () => {
    const ranked = splats(50);
    const onlyThird = await check({ ranked, isListed: (bin) => bin === 2 });
    expect(onlyThird.covered).toBeGreaterThan(0);
    for (let pixel = 0; pixel < BIN_PX; pixel++) expect(onlyThird.data[4 * pixel + 3]).toBe(0);
    const nothing = await check({ ranked, isMasked: () => false });
    expect(nothing.data.every((value) => value === 0)).toBe(true);
  });

  gpuTest('larger bins over layers of any size', async () => {
    for (const [widthPx, heightPx, binShift] of [
      [75, 69, 1],
      [75, 69, 3],
      [1, 1, 1],
      [330, 140, 1],
      [140, 330, 2],
      [512, 64, 3],
    ]) {
      const size = { widthPx, heightPx };
      expect((await check({ ranked: splats(90, size), size, binShift })).covered).toBeGreaterThan(0);
    }
  });

  gpuTest('bins that begin at every place of a word', async () => {
    const ranked = splats(70);
    for (let length = 1; length < 33; length += 3)
      await check({ ranked, isListed: (bin, rank) => (bin === 0 ? rank < length : rank % 2 === bin % 2) });
  });

  gpuTest('a tile ends when less than 2⁻¹⁶ of the light behind passes through, and not before', async () => {
    // 16,000 times as bright as white, so that it shows through less than that.
    const bright = veil(0.99, { rgb: [16_384, 16_384, 16_384] });
    const brightAt = async (front: readonly DrawnSplat[]) => {
      const faint = Array<DrawnSplat>(TILE_THREADS - front.length).fill(veil(0.001));
      const ranked = [...front, ...faint, bright];
      const { data, ended } = await check({ ranked, isListed: always, isMasked: always });
      return { red: data[0], ended };
    };
    // 10⁻⁴ · 0.2 = 2⁻¹⁵·⁶, and 10⁻⁴ · 0.1 = 2⁻¹⁶·⁶.
    const open = await brightAt([veil(1), veil(1), veil(0.8)]);
    expect(open.red).toBeCloseTo(1 + 2e-5 * 0.99 * 16_384, 2);
    expect(open.ended).toBe(0);
    const closed = await brightAt([veil(1), veil(1), veil(0.9)]);
    expect(closed.red).toBeCloseTo(1, 3);
    expect(closed.ended).toBe(SIZE.widthPx * SIZE.heightPx);
  });

  gpuTest('a tile with one open pixel does not end', async () => {
    // All pixels but those around the corner of the first tile are opaque.
    const disc = { majorLengthPx: 6, minorLengthPx: 6, centerPx: [7.5, 7.5] } as const;
    const ranked = [
      ...Array<DrawnSplat>(2 * TILE_THREADS).fill(veil(1, disc)),
      ...splats(100).map((splat) => ({ ...splat, opacity: 0.9 })),
    ];
    const { covered } = await check({ ranked, isListed: always, isMasked: always });
    expect(covered).toBe(SIZE.widthPx * SIZE.heightPx);
  });

  gpuTest('full opacity is capped, and opacities below the cutoff draw nothing', async () => {
    const capped = await check({ ranked: [veil(1)], isListed: always, isMasked: always });
    expect(capped.data[3]).toBeCloseTo(0.99, 6);
    const faint = await check({ ranked: [veil(0.0039)], isListed: always, isMasked: always });
    expect(faint.covered).toBe(0);
    expect(faint.data.every((value) => value === 0)).toBe(true);
  });
});

const place = { position: [0, 0, 4], target: [0, 0, 0], aspect: 75 / 69, near: 0.5, far: 40 } as const;
const perspective = withClipDepth(perspectiveCamera({ ...place, fovYDegrees: 50 }), false);
const orthographic = withClipDepth(orthographicCamera({ ...place, height: 3 }), false);
const tilted = (camera: Camera): Camera => {
  const matrix = Float64Array.from(camera.projectionMatrix);
  matrix[2] = 0.02;
  matrix[6] = -0.03;
  return cameraFromMatrices(camera.viewMatrix, matrix, camera);
};
const CONVENTIONS: Readonly<
  Record<string, readonly [Camera, DepthConvention['mapping'], DepthConvention['compare']]>
> = {
  'depth as projected': [perspective, 'projection', 'less-equal'],
  'reversed depth': [withClipDepth(perspective, true), 'projection', 'greater-equal'],
  'a tilted near plane': [tilted(perspective), 'projection', 'less-equal'],
  'a tilted near plane, reversed': [tilted(withClipDepth(perspective, true)), 'projection', 'greater-equal'],
  'depth of parallel rays': [orthographic, 'projection', 'less-equal'],
  'reversed depth of parallel rays': [withClipDepth(orthographic, true), 'projection', 'greater-equal'],
  'logarithmic depth': [perspective, 'logarithmic', 'less-equal'],
  'logarithmic depth of parallel rays': [orthographic, 'logarithmic', 'less-equal'],
};

/** Surfaces of the host between the depths of `splats`, in stripes; nothing in between. */
const surfaceView = (x: number, y: number) =>
  [1.7, 3.1, Number.POSITIVE_INFINITY, 22, 0.6][(Math.floor(x / 5) + Math.floor(y / 9)) % 5];

describe('tile-rasterize with the depth of a host', () => {
  const isFull = process.env.WEBSPLATTER_FULL === '1';
  const conventions = Object.entries(CONVENTIONS);
  for (const [index, [name, [camera, mapping, compare]]] of conventions.entries()) {
    gpuTest(`${name}: hides splats, and writes the median of their depth`, async () => {
      const host = { camera, mapping, compare, surfaceView, isExactOrder: true };
      const scene = { ranked: splats(200, SIZE, 0.4) };
      const { covered, hidden, medians } = await check({ ...scene, host: { ...host, hasDepthLayer: true } });
      expect(covered).toBeGreaterThan(2000);
      expect(medians).toBeGreaterThan(1000);
      expect(hidden).toBeGreaterThan(2000);
      // The host's depth means the same whether a depth is written or not.
      if (isFull || index === 0) await check({ ...scene, host: { ...host, hasDepthLayer: false } });
    });

    gpuTest(`${name}: splats that short keys leave unordered`, async ({ skip }) => {
      // The order of splats does not change the meaning of the host's depth.
      if (!isFull && index > 0) skip('set WEBSPLATTER_FULL=1');
      const inOrder = splats(200, SIZE, 0.4);
      const ranked = Array.from(shuffled(inOrder.length), (rank) => inOrder[rank]);
      const host = { camera, mapping, compare, surfaceView, isExactOrder: false, hasDepthLayer: true };
      const { hidden } = await check({ ranked, host });
      expect(hidden).toBeGreaterThan(2000);
    });
  }

  gpuTest('a depth that rounding alone puts outside of 0…1 is not clipped', async () => {
    const host = { camera: perspective, mapping: 'projection', compare: 'less-equal' } as const;
    const nowhere = { surfaceView: () => Number.POSITIVE_INFINITY, isExactOrder: true, hasDepthLayer: true };
    for (const depthView of [0.5 * (1 - 2e-6), 40 * (1 + 1e-4)]) {
      const stored = depthMapping(perspective, 'projection');
      const depth = stored.offset + stored.factor / depthView;
      expect(depth < 0 || depth > 1).toBe(true);
      const ranked = [veil(0.7, { depthView })];
      const { covered } = await check({
        ranked,
        host: { ...host, ...nowhere },
        isMasked: always,
        isListed: always,
      });
      expect(covered).toBe(SIZE.widthPx * SIZE.heightPx);
    }
  });
});
