import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import {
  BLOB_OPACITY_STEPS,
  LOG_SCALE_STEPS,
  MOST_COLOR_STEPS,
  OPACITY_STEPS,
  POSITION_BITS,
  ROTATION_STEPS,
  SUM_OF_ONE,
  SUM_STEPS,
} from './bricks-layout.ts';
import { PlaneReader, unzigzag } from './planes.ts';

/** The N leaves of a brick, as columns. */
export interface LeafColumns {
  readonly count: number;
  /** 3N coordinates relative to the scene's origin, within the bounds of their cell. */
  readonly positions: Float32Array;
  readonly logScales: Float32Array;
  /** 4N: unit quaternions w, x, y, z. */
  readonly rotations: Float32Array;
  /** N opacities; above 1 for some blobs. */
  readonly opacities: Float32Array;
  /** 3N base colour coefficients. */
  readonly colorDc: Float32Array;
  /** 2N numbers for blobs: opacity times rim length, and opacity. */
  readonly sums: Float32Array;
}

const POSITION_STEPS = 2 ** POSITION_BITS - 1;
/** Longest step with which every colour fits into float16. */
const LONGEST_COLOR_STEP = 65504 / MOST_COLOR_STEPS;

/**
 * Decodes the output of `encodeGeometry`.
 *
 * @param bytes exactly `geometryBytes` bytes.
 * @param bounds bounds of the cells; each but the last has CHUNK_SPLATS leaves.
 * @returns null if a number is outside of its encoded range.
 */
export function decodeGeometry(
  bytes: Uint8Array,
  level: number,
  count: number,
  bounds: readonly Bounds[],
): LeafColumns | null {
  const colorStep = new DataView(bytes.buffer, bytes.byteOffset).getFloat32(0, true);
  if (!(colorStep > 0 && colorStep <= LONGEST_COLOR_STEP)) return null;
  const positions = new Float32Array(3 * count);
  const logScales = new Float32Array(3 * count);
  const rotations = new Float32Array(4 * count);
  const opacities = new Float32Array(count);
  const colorDc = new Float32Array(3 * count);
  const sums = new Float32Array(level === 0 ? 0 : 2 * count);
  const planes = new PlaneReader(bytes, count, 4);
  for (let axis = 0; axis < 3; axis++) {
    let step = 0;
    planes.wide((leaf, bits) => {
      step = (step + unzigzag(bits)) & POSITION_STEPS;
      const { min, max } = bounds[Math.floor(leaf / CHUNK_SPLATS)];
      const position = min[axis] + (step / POSITION_STEPS) * (max[axis] - min[axis]);
      positions[3 * leaf + axis] = Math.min(position, max[axis]);
    });
  }
  planes.differences((leaf, steps) => {
    for (let channel = 0; channel < 3; channel++) colorDc[3 * leaf + channel] = colorStep * steps;
  });
  for (const channel of [0, 2])
    planes.differences((leaf, steps) => {
      colorDc[3 * leaf + channel] += colorStep * steps;
    });
  for (let axis = 0; axis < 3; axis++)
    planes.differences((leaf, steps) => {
      logScales[3 * leaf + axis] = steps / LOG_SCALE_STEPS;
    });
  for (let k = 1; k <= 3; k++)
    planes.narrow((leaf, byte) => {
      rotations[4 * leaf + k] = ((byte - ROTATION_STEPS) / ROTATION_STEPS) * Math.SQRT1_2;
    });
  for (let at = 0; at < 4 * count; at += 4) {
    const squares = rotations[at + 1] ** 2 + rotations[at + 2] ** 2 + rotations[at + 3] ** 2;
    rotations[at] = Math.sqrt(Math.max(0, 1 - squares));
  }
  if (level === 0) {
    planes.narrow((leaf, byte) => {
      opacities[leaf] = byte / OPACITY_STEPS;
    });
  } else {
    const logStep = Math.log1p(LEVEL_CONSTANTS.MOST_OPACITY) / BLOB_OPACITY_STEPS;
    planes.wide((leaf, steps) => {
      opacities[leaf] = Math.expm1(logStep * Math.min(steps, BLOB_OPACITY_STEPS));
    });
    for (let k = 0; k < 2; k++)
      planes.differences((leaf, code) => {
        sums[2 * leaf + k] = code > 0 ? Math.exp((code - SUM_OF_ONE) / SUM_STEPS) : 0;
      });
  }
  return { count, positions, logScales, rotations, opacities, colorDc, sums };
}
