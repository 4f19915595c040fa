import { floatAbove, floatBelow } from '../../../data/math/float-step.ts';
import { emptyBounds, widenBounds } from '../../../data/packing/center-bounds.ts';
import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { mortonOrderInTurns } from '../../../data/packing/morton-order.ts';
import { largestComponent, normalizedRotation } from '../../../data/packing/rotation.ts';
import { colorOf, opacityOf } from '../../../data/splats/color-values.ts';
import { coefficientsPerSplat, type SplatSet } from '../../../data/splats/splat-set.ts';
import { Turns } from '../../../data/turns.ts';
import { antialiasComments } from '../ply/write-ply.ts';
import { medianSizeOf, type RoundingAdvice, RoundingMeter } from '../rows/rounding-meter.ts';
import {
  fileMemory,
  partOfProgress,
  type WriteFormat,
  type WriteOptions,
  writeInTurns,
} from '../write-format.ts';
import { BOUNDED, boundsNames, CHUNK_ROWS, PACKED } from './chunk-layout.ts';

/** Readers accept a chunk element only if its properties are exactly these. */
const CHUNK_PROPERTIES = Object.values(BOUNDED).flatMap(boundsNames);
/** Bounded values per splat: x, y, z, three log scales, r, g, b. */
const BOUNDED_VALUES = 9;
/** Clamp limit, as in other writers: one extremely large or thin splat would coarsen its chunk. */
const MOST_LOG_SCALE = 20;
/** Steps of harmonics per unit, then the largest value. */
const SH_STEPS = 32;
const MOST_SH = 4;
const ADVICE: RoundingAdvice = {
  title: 'compressed PLY',
  positions: 'Crop splats far outside of the others, move the scene to 0, or write PLY or glTF',
};
const VERTEX_BYTES = 4 * PACKED.length;
/** Progress when the splats are sorted. */
const ORDERED = 0.25;
/** Progress of the sort when the bounds of the scene are known, and the positions relative to them. */
const ORDER_PROGRESS = { bounds: 0.1, unit: 0.2 } as const;

/**
 * Writes a compressed PLY, in chunks of 256 splats in the order of `chunkOrder`. Bits per value:
 *
 * - positions and log scales: 10 or 11, between the least and greatest value of their chunk
 * - base colours: 8, likewise
 * - opacities: 8, between 0 and 1
 * - rotation components: 10
 * - harmonics: 8, between −4 and 4
 *
 * Bounds are float32, rounded outwards for positions.
 */
export const write: WriteFormat = async (set, options) => {
  const { count, harmonics } = set;
  const header = new TextEncoder().encode(headerText(set));
  const shValues = coefficientsPerSplat(harmonics.degree);
  const chunkBytes = 4 * CHUNK_PROPERTIES.length;
  const vertexStart = header.length + Math.ceil(count / CHUNK_ROWS) * chunkBytes;
  const shStart = vertexStart + count * VERTEX_BYTES;
  const bytes = fileMemory(shStart + count * shValues);
  bytes.set(header);
  const view = new DataView(bytes.buffer);
  const order = await chunkOrder(set, partOfProgress(options, 0, ORDERED));
  const chunk = new Chunk(set);
  const meter = new RoundingMeter(medianSizeOf(set));
  const sh = new Float32Array(shValues);
  await writeInTurns(count, partOfProgress(options, ORDERED, 1), (from, to) => {
    for (let row = from; row < to; row++) {
      if (row % CHUNK_ROWS === 0) {
        chunk.take(order.subarray(row, row + CHUNK_ROWS));
        chunk.putBounds(view, header.length + (row / CHUNK_ROWS) * chunkBytes);
      }
      chunk.putSplat(row % CHUNK_ROWS, order[row], view, vertexStart + row * VERTEX_BYTES);
      chunk.measure(order[row], meter);
      readCoefficients(harmonics, order[row], sh);
      putHarmonics(sh, bytes, shStart + row * shValues);
    }
  });
  for (const note of meter.notes(ADVICE)) options.onNote?.(note);
  return bytes;
};

/**
 * The splat index of each row. Morton order makes chunks small. Cells with the scene's proportions
 * instead of cubes made them a tenth to a seventh smaller in tested scenes.
 *
 * Rejects with the signal's reason.
 */
export async function chunkOrder(
  { positions, count }: SplatSet<Harmonics>,
  options: WriteOptions,
): Promise<Uint32Array> {
  const bounds = emptyBounds();
  await writeInTurns(count, partOfProgress(options, 0, ORDER_PROGRESS.bounds), (from, to) =>
    widenBounds(bounds, positions, from, to),
  );
  const { min, max } = bounds;
  // Above 0, for flat scenes.
  const extents = max.map((value, axis) => Math.max(value - min[axis], Number.MIN_VALUE));
  const unit = new Float32Array(3 * count);
  const { bounds: begun, unit: done } = ORDER_PROGRESS;
  await writeInTurns(count, partOfProgress(options, begun, done), (from, to) => {
    for (let i = 3 * from; i < 3 * to; i++) unit[i] = (positions[i] - min[i % 3]) / extents[i % 3];
  });
  const { signal, onProgress } = partOfProgress(options, done, 1);
  return mortonOrderInTurns(unit, count, new Turns(signal), onProgress);
}

function headerText(set: SplatSet<Harmonics>): string {
  const shValues = coefficientsPerSplat(set.harmonics.degree);
  return [
    'ply',
    'format binary_little_endian 1.0',
    ...antialiasComments(set),
    `element chunk ${Math.ceil(set.count / CHUNK_ROWS)}`,
    ...CHUNK_PROPERTIES.map((name) => `property float ${name}`),
    `element vertex ${set.count}`,
    ...PACKED.map((name) => `property uint ${name}`),
    ...(shValues > 0 ? [`element sh ${set.count}`] : []),
    ...Array.from({ length: shValues }, (_, i) => `property uchar f_rest_${i}`),
    'end_header',
    '',
  ].join('\n');
}

/** Splats that share bounds. */
class Chunk {
  readonly #set: SplatSet<Harmonics>;
  /** Bounded values, by splat within the chunk. */
  readonly #values = new Float64Array(CHUNK_ROWS * BOUNDED_VALUES);
  /** In float32, as readers decode them. */
  readonly #least = new Float32Array(BOUNDED_VALUES);
  readonly #greatest = new Float32Array(BOUNDED_VALUES);
  readonly #rotation = new Float64Array(4);

  constructor(set: SplatSet<Harmonics>) {
    this.#set = set;
  }

  /** @param splats indices within the set. */
  take(splats: Uint32Array): void {
    const { positions, origin, logScales, colorDc } = this.#set;
    this.#least.fill(Number.POSITIVE_INFINITY);
    this.#greatest.fill(Number.NEGATIVE_INFINITY);
    for (let i = 0; i < splats.length; i++) {
      const at = i * BOUNDED_VALUES;
      for (let k = 0; k < 3; k++) {
        const from = 3 * splats[i] + k;
        this.#values[at + k] = positions[from] + origin[k];
        this.#values[at + 3 + k] = cutLogScale(logScales[from]);
        this.#values[at + 6 + k] = colorOf(colorDc[from]);
      }
      for (let k = 0; k < BOUNDED_VALUES; k++) {
        const value = this.#values[at + k];
        // Far from 0, the nearest float32 may exclude positions from their own bounds.
        this.#least[k] = Math.min(this.#least[k], k < 3 ? floatBelow(value) : value);
        this.#greatest[k] = Math.max(this.#greatest[k], k < 3 ? floatAbove(value) : value);
      }
    }
  }

  putBounds(view: DataView, byteOffset: number): void {
    let at = byteOffset;
    for (let first = 0; first < BOUNDED_VALUES; first += 3) {
      for (const bounds of [this.#least, this.#greatest]) {
        for (let k = first; k < first + 3; k++, at += 4) view.setFloat32(at, bounds[k], true);
      }
    }
  }

  /**
   * @param i index within the chunk.
   * @param splat index within the set.
   */
  putSplat(i: number, splat: number, view: DataView, byteOffset: number): void {
    const step = (value: number, most: number) => this.#stepOf(i, value, most);
    const opacity = Math.round(255 * opacityOf(this.#set.opacityLogits[splat]));
    const color = (step(6, 255) << 24) | (step(7, 255) << 16) | (step(8, 255) << 8) | opacity;
    normalizedRotation(this.#set.rotations, 4 * splat, this.#rotation);
    view.setUint32(byteOffset, (step(0, 2047) << 21) | (step(1, 1023) << 11) | step(2, 2047), true);
    view.setUint32(byteOffset + 4, smallestThree(this.#rotation), true);
    view.setUint32(byteOffset + 8, (step(3, 2047) << 21) | (step(4, 1023) << 11) | step(5, 2047), true);
    view.setUint32(byteOffset + 12, color, true);
  }

  /** Adds the rounding errors of a splat of the chunk. */
  measure(splat: number, meter: RoundingMeter): void {
    const set = this.#set;
    const stepOf = (value: number, most: number) => (this.#greatest[value] - this.#least[value]) / most;
    meter.position(set, splat, Math.max(stepOf(0, 2047), stepOf(1, 1023), stepOf(2, 2047)));
    meter.float32Position(set, splat);
    meter.scales(set, splat, (axis) => cutLogScale(set.logScales[3 * splat + axis]));
    meter.harmonics(set, splat, (value) => (harmonicsByte(value) + 0.5) / SH_STEPS - MOST_SH);
  }

  /** The step, 0 to `most`, nearest to a value of a splat. */
  #stepOf(i: number, value: number, most: number): number {
    const least = this.#least[value];
    const extent = this.#greatest[value] - least;
    const steps = Math.round(((this.#values[i * BOUNDED_VALUES + value] - least) / extent) * most);
    // Clamped because bounds are rounded; a single value has no extent.
    return extent > 0 ? Math.max(0, Math.min(most, steps)) : 0;
  }
}

/** Index of the largest of w, x, y, z, made positive, and the others: 10 bits each, from −√½ to √½. */
function smallestThree(rotation: Float64Array): number {
  const largest = largestComponent(rotation);
  const factor = (rotation[largest] < 0 ? -1 : 1) * Math.SQRT1_2;
  let packed = largest;
  for (let i = 0; i < 4; i++)
    if (i !== largest) packed = (packed << 10) | Math.round(1023 * (factor * rotation[i] + 0.5));
  return packed;
}

function cutLogScale(logScale: number): number {
  return Math.max(-MOST_LOG_SCALE, Math.min(MOST_LOG_SCALE, logScale));
}

/** The step of a coefficient: 256 steps between −4 and 4. */
function harmonicsByte(coefficient: number): number {
  return Math.max(0, Math.min(255, Math.floor(SH_STEPS * (coefficient + MOST_SH))));
}

/** Writes the step of each coefficient: all of red, then green, then blue. */
function putHarmonics(sh: Float32Array, bytes: Uint8Array, byteOffset: number): void {
  let at = byteOffset;
  for (let channel = 0; channel < 3; channel++) {
    for (let k = channel; k < sh.length; k += 3, at++) bytes[at] = harmonicsByte(sh[k]);
  }
}
