import { InvalidArgumentError, WebSplatterError } from '../data/errors.ts';
import { COMPARE_CONSTANTS, CompareParameters, CompareTile } from '../data/layout/compare-structs.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines } from '../gpu/pipelines.ts';
import { readBack } from '../gpu/read-back.ts';
import { readFromScratch } from '../gpu/read-from-scratch.ts';
import type { ImageDifference } from '../stages/measure/measure.reference.ts';
import { compareImages, countedError, ERROR_COUNTS } from '../stages/measure/measure.ts';

/** Thrown for an image with non-finite values, which has no distance to any other. */
export class NonFiniteImageError extends WebSplatterError {
  override readonly name = 'NonFiniteImageError';
  readonly image: 'actual' | 'expected';
  /** Pixels with such a value. */
  readonly pixels: number;

  constructor(image: 'actual' | 'expected', pixels: number, [xPx, yPx]: readonly [xPx: number, yPx: number]) {
    const { COMPARE_TILE_PX: side } = COMPARE_CONSTANTS;
    super(
      'non-finite-image',
      `The ${image === 'actual' ? 'compared' : 'expected'} image has values that are not finite in ${pixels} pixels, the first of them in the ${side}×${side} px from ${xPx}, ${yPx}.`,
    );
    this.image = image;
    this.pixels = pixels;
  }
}

/** The parts of an engine that comparing needs. */
export interface CompareContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  readonly memory: GpuMemory;
}

/**
 * Compares two layers of premultiplied RGBA on the GPU. The result is that of `compareImages` of
 * measure.reference.ts with `quantize: 'raw'`, except for the rounding of float32. The percentile has a
 * relative error of at most 1/256.
 *
 * Submits before it returns, so that later drawing into the textures makes no difference.
 *
 * @param background colour behind both, 0…1.
 * @throws InvalidArgumentError for textures of different sizes, NonFiniteImageError.
 */
export async function compareTextures(
  { device, pipelines, memory }: CompareContext,
  actual: GPUTexture,
  expected: GPUTexture,
  background: Vec3 = [0, 0, 0],
): Promise<ImageDifference> {
  const { width, height } = actual;
  if (expected.width !== width || expected.height !== height) {
    const message = `Images of ${width}×${height} and ${expected.width}×${expected.height} px cannot be compared; draw both in one size.`;
    throw new InvalidArgumentError('expected', message);
  }
  if (!pipelines.areReady([compareImages])) await pipelines.prepare([compareImages]);
  const tilesAcross = Math.ceil(width / COMPARE_CONSTANTS.COMPARE_TILE_PX);
  const tilesDown = Math.ceil(height / COMPARE_CONSTANTS.COMPARE_TILE_PX);
  const tileBytes = CompareTile.bytes * tilesAcross * tilesDown;
  const countBytes = 4 * ERROR_COUNTS;
  const { UNIFORM, STORAGE, COPY_SRC, COPY_DST } = GPUBufferUsage;
  const compare = (scratch: GpuMemory) => {
    const parameters = scratch.createBuffer(
      'compare parameters',
      CompareParameters.bytes,
      UNIFORM | COPY_DST,
    );
    const tiles = scratch.createBuffer('compare tiles', tileBytes, STORAGE | COPY_SRC);
    const errorCounts = scratch.createBuffer('compare error counts', countBytes, STORAGE | COPY_SRC);
    device.queue.writeBuffer(parameters, 0, CompareParameters.pack({ background }));
    const layers = { actual: actual.createView(), expected: expected.createView() };
    const group = pipelines.bindGroup(compareImages, { parameters, tiles, errorCounts, ...layers });
    return readBack(device, tileBytes + countBytes, (encoder, target) => {
      const pass = encoder.beginComputePass({ label: 'compare' });
      pass.setPipeline(pipelines.compute(compareImages)!);
      pass.setBindGroup(0, group);
      pass.dispatchWorkgroups(tilesAcross, tilesDown);
      pass.end();
      encoder.copyBufferToBuffer(tiles, 0, target, 0, tileBytes);
      encoder.copyBufferToBuffer(errorCounts, 0, target, tileBytes, countBytes);
    });
  };
  const read = await readFromScratch(memory, 'Comparing', 'Compare smaller images.', compare);
  const counts = new Uint32Array(read, tileBytes, ERROR_COUNTS);
  return differenceOf(new DataView(read, 0, tileBytes), counts, width, height);
}

/** @param tiles a `CompareTile` per tile; @param counts number of errors by size, without zeros. */
function differenceOf(
  tiles: DataView,
  counts: Uint32Array,
  widthPx: number,
  heightPx: number,
): ImageDifference {
  const values = 3 * widthPx * heightPx;
  let squaredErrorSum = 0;
  let dissimilaritySum = 0;
  let maxError = 0;
  for (let at = 0; at < tiles.byteLength; at += CompareTile.bytes) {
    const { offsets } = CompareTile;
    squaredErrorSum += tiles.getFloat32(at + offsets.squaredErrorSum, true);
    dissimilaritySum += tiles.getFloat32(at + offsets.dissimilaritySum, true);
    maxError = Math.max(maxError, tiles.getFloat32(at + offsets.maxError, true));
  }
  checkFinite(tiles, 'actual', widthPx);
  checkFinite(tiles, 'expected', widthPx);
  return {
    psnrDb: squaredErrorSum === 0 ? Number.POSITIVE_INFINITY : -10 * Math.log10(squaredErrorSum / values),
    maxError,
    p999Error: Math.min(maxError, percentile(counts, values, maxError)),
    ssim: 1 - dissimilaritySum / values,
  };
}

/** Returns the 99.9th percentile, by the same rank as on the CPU. */
function percentile(counts: Uint32Array, values: number, maxError: number): number {
  const rank = Math.min(values - 1, Math.floor(0.999 * values));
  // The largest error is known exactly.
  if (rank === values - 1) return maxError;
  let above = values - 1 - rank;
  for (let index = ERROR_COUNTS - 1; index >= 0; index--) {
    if (above < counts[index]) return countedError(index);
    above -= counts[index];
  }
  return 0;
}

function checkFinite(tiles: DataView, image: 'actual' | 'expected', widthPx: number): void {
  const { COMPARE_TILE_PX } = COMPARE_CONSTANTS;
  const offset = CompareTile.offsets[image === 'actual' ? 'brokenActual' : 'brokenExpected'];
  let pixels = 0;
  let firstTile = -1;
  for (let tile = 0; tile * CompareTile.bytes < tiles.byteLength; tile++) {
    const broken = tiles.getUint32(tile * CompareTile.bytes + offset, true);
    if (broken > 0 && firstTile < 0) firstTile = tile;
    pixels += broken;
  }
  if (pixels === 0) return;
  const tilesAcross = Math.ceil(widthPx / COMPARE_TILE_PX);
  const [column, row] = [firstTile % tilesAcross, Math.floor(firstTile / tilesAcross)];
  throw new NonFiniteImageError(image, pixels, [COMPARE_TILE_PX * column, COMPARE_TILE_PX * row]);
}
