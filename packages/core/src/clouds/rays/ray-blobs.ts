import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import type { GeometryPiece } from '../geometry-pieces.ts';
import {
  areaOf,
  COVARIANCE,
  LEAST_OPACITY,
  OPACITY,
  SHAPE_VALUES,
  SIZE,
  shapeReader,
  WEIGHT,
} from '../splat-shape.ts';

/**
 * Largest opacity of a blob at its centre. It may exceed 1: overlapping splats together stay opaque
 * farther out than a single one.
 */
export const MOST_OPACITY = 3;
/** Offset of the position in a shape. */
const X = 0;
/** Values per blob. */
export const LOOSE_VALUES = 10;
/**
 * Splats are clustered by x, y, z and size, so that a floor and the haze above it are not merged.
 */
const AXES = [X, X + 1, X + 2, SIZE] as const;

interface Cluster {
  readonly start: number;
  readonly end: number;
  /** Reduction of the weighted variance by a split. */
  score: number;
  axis: number;
  middle: number;
}

/**
 * Merges a cloud's splats into blobs. A blob is one Gaussian for several neighbouring splats, with
 * their common mean, covariance and opacity.
 */
export class BlobCollector {
  #count = 0;
  /** LOOSE_VALUES per blob: mean, covariance, opacity. */
  readonly #blobs: Float32Array;
  /** Splats to merge, SHAPE_VALUES each. */
  readonly #splats = new Float64Array(CHUNK_SPLATS * SHAPE_VALUES);
  readonly #order = new Uint16Array(CHUNK_SPLATS);

  /** @param most most blobs over all calls of `add`. */
  constructor(most: number) {
    this.#blobs = new Float32Array(LOOSE_VALUES * most);
  }

  /**
   * Merges splats `from`…`end` of `geometry`, neighbours in storage order and at most CHUNK_SPLATS,
   * into at most `wanted` blobs.
   */
  add(geometry: GeometryPiece, from: number, end: number, wanted: number): void {
    let kept = 0;
    const read = shapeReader(geometry);
    for (let i = from; i < end; i++) if (read(i, this.#splats, SHAPE_VALUES * kept)) kept++;
    if (kept === 0) return;
    if (wanted >= kept) {
      for (let i = 0; i < kept; i++)
        this.#put(this.#splats.subarray(SHAPE_VALUES * i, SHAPE_VALUES * (i + 1)));
      return;
    }
    for (let i = 0; i < kept; i++) this.#order[i] = i;
    for (const { start, end } of this.#clusters(kept, wanted)) this.#put(this.#merged(start, end));
  }

  /** Returns mean, covariance and opacity of the blobs so far, LOOSE_VALUES each. */
  get blobs(): Float32Array {
    return this.#blobs.subarray(0, LOOSE_VALUES * this.#count);
  }

  /**
   * Splits the first `count` splats into `wanted` clusters; fewer if splats coincide. Neighbouring
   * clusters in the list are neighbours in space.
   */
  #clusters(count: number, wanted: number): Cluster[] {
    const clusters = [this.#cluster(0, count)];
    while (clusters.length < wanted) {
      let worst = 0;
      for (let i = 1; i < clusters.length; i++) if (clusters[i].score > clusters[worst].score) worst = i;
      const { start, end, score, axis, middle } = clusters[worst];
      if (!(score > 0)) break;
      const between = this.#partition(start, end, axis, middle);
      if (between === start || between === end) {
        // Rounding moved the mean onto the outermost splat.
        clusters[worst].score = 0;
        continue;
      }
      clusters.splice(worst, 1, this.#cluster(start, between), this.#cluster(between, end));
    }
    return clusters;
  }

  #cluster(start: number, end: number): Cluster {
    const cluster: Cluster = { start, end, score: 0, axis: 0, middle: 0 };
    if (end - start < 2) return cluster;
    const splats = this.#splats;
    for (const axis of AXES) {
      let weight = 0;
      let sum = 0;
      let squares = 0;
      const base = splats[SHAPE_VALUES * this.#order[start] + axis];
      for (let i = start; i < end; i++) {
        const at = SHAPE_VALUES * this.#order[i];
        const w = splats[at + WEIGHT];
        const value = splats[at + axis] - base;
        weight += w;
        sum += w * value;
        squares += w * value * value;
      }
      const score = squares - (sum * sum) / weight;
      if (score > cluster.score) {
        cluster.score = score;
        cluster.axis = axis;
        cluster.middle = base + sum / weight;
      }
    }
    return cluster;
  }

  /** Moves splats up to `middle` before the others. @returns the index of the first other splat. */
  #partition(start: number, end: number, axis: number, middle: number): number {
    const order = this.#order;
    let low = start;
    let high = end;
    while (low < high) {
      const splat = order[low];
      if (this.#splats[SHAPE_VALUES * splat + axis] <= middle) low++;
      else {
        high--;
        order[low] = order[high];
        order[high] = splat;
      }
    }
    return low;
  }

  #merged(start: number, end: number): Float64Array {
    const splats = this.#splats;
    const first = SHAPE_VALUES * this.#order[start];
    if (end - start === 1) return splats.subarray(first, first + SHAPE_VALUES);
    const merged = new Float64Array(SHAPE_VALUES);
    let weight = 0;
    for (let i = start; i < end; i++) {
      const at = SHAPE_VALUES * this.#order[i];
      const w = splats[at + WEIGHT];
      weight += w;
      // Relative to the first splat, because moments about 0 would lose digits of the covariance.
      const dx = splats[at] - splats[first];
      const dy = splats[at + 1] - splats[first + 1];
      const dz = splats[at + 2] - splats[first + 2];
      merged[X] += w * dx;
      merged[X + 1] += w * dy;
      merged[X + 2] += w * dz;
      merged[COVARIANCE] += w * (splats[at + COVARIANCE] + dx * dx);
      merged[COVARIANCE + 1] += w * (splats[at + COVARIANCE + 1] + dy * dy);
      merged[COVARIANCE + 2] += w * (splats[at + COVARIANCE + 2] + dz * dz);
      merged[COVARIANCE + 3] += w * (splats[at + COVARIANCE + 3] + dx * dy);
      merged[COVARIANCE + 4] += w * (splats[at + COVARIANCE + 4] + dx * dz);
      merged[COVARIANCE + 5] += w * (splats[at + COVARIANCE + 5] + dy * dz);
    }
    for (let k = 0; k < OPACITY; k++) merged[k] /= weight;
    const [x, y, z] = merged;
    merged[COVARIANCE] -= x * x;
    merged[COVARIANCE + 1] -= y * y;
    merged[COVARIANCE + 2] -= z * z;
    merged[COVARIANCE + 3] -= x * y;
    merged[COVARIANCE + 4] -= x * z;
    merged[COVARIANCE + 5] -= y * z;
    for (let axis = 0; axis < 3; axis++) merged[axis] += splats[first + axis];
    // The blob keeps the sum of opacity times area of its splats.
    merged[OPACITY] = Math.min(MOST_OPACITY, weight / areaOf(merged, COVARIANCE));
    return merged;
  }

  #put(blob: Float64Array): void {
    if (!(blob[OPACITY] > LEAST_OPACITY)) return;
    this.#blobs.set(blob.subarray(0, LOOSE_VALUES), LOOSE_VALUES * this.#count++);
  }
}
