import type { Brick } from '../../../data/bricks/brick.ts';
import { emptyLeaf } from '../../../data/bricks/cell-merger.ts';
import { blobReader, leafReader } from '../../../data/bricks/leaf-reader.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import { clampLogScale } from '../../../data/packing/log-scale.ts';
import { largestComponent } from '../../../data/packing/rotation.ts';
import {
  BLOB_OPACITY_STEPS,
  BLOB_PLANES,
  COLOR_STEP,
  LOG_SCALE_STEPS,
  MOST_COLOR_STEPS,
  MOST_SUM,
  OPACITY_STEPS,
  POSITION_BITS,
  ROTATION_STEPS,
  SPLAT_PLANES,
  SUM_OF_ONE,
  SUM_STEPS,
} from './bricks-layout.ts';
import { PlaneWriter, zigzag } from './planes.ts';

const POSITION_STEPS = 2 ** POSITION_BITS - 1;
const HALF_TURN = 2 ** (POSITION_BITS - 1);

/** Encodes the geometry of a brick as rounded bytes: see bricks-layout.ts. */
export function encodeGeometry(brick: Brick): Uint8Array<ArrayBuffer> {
  const { level, cells } = brick;
  const count = cells.reduce((sum, { leafCount }) => sum + leafCount, 0);
  const columns = columnsOf(brick, count);
  const { positions, logScales, rotations, opacities, colors, sums } = columns;
  let brightest = 0;
  for (const value of colors) brightest = Math.max(brightest, Math.abs(value));
  const colorStep = Math.fround(Math.max(COLOR_STEP, brightest / MOST_COLOR_STEPS));
  const planes = new PlaneWriter(count, 4, level === 0 ? SPLAT_PLANES : BLOB_PLANES);
  new DataView(planes.bytes.buffer).setFloat32(0, colorStep, true);
  for (let axis = 0; axis < 3; axis++) {
    let before = 0;
    planes.wide((leaf) => {
      const { min, max } = cells[Math.floor(leaf / CHUNK_SPLATS)].bounds;
      const part = (positions[3 * leaf + axis] - min[axis]) / (max[axis] - min[axis]);
      const step = max[axis] > min[axis] ? Math.round(part * POSITION_STEPS) : 0;
      // Differences wrap around, so they need no more bits than coordinates.
      const difference = ((step - before + HALF_TURN) & POSITION_STEPS) - HALF_TURN;
      before = step;
      return zigzag(difference);
    });
  }
  const colorSteps = (leaf: number, channel: number) => {
    const steps = Math.round(colors[3 * leaf + channel] / colorStep);
    return Math.max(-MOST_COLOR_STEPS, Math.min(MOST_COLOR_STEPS, steps));
  };
  planes.differences((leaf) => colorSteps(leaf, 1));
  planes.differences((leaf) => colorSteps(leaf, 0) - colorSteps(leaf, 1));
  planes.differences((leaf) => colorSteps(leaf, 2) - colorSteps(leaf, 1));
  for (let axis = 0; axis < 3; axis++)
    planes.differences((leaf) => Math.round(LOG_SCALE_STEPS * logScales[3 * leaf + axis]));
  for (let k = 0; k < 3; k++) planes.narrow((leaf) => rotations[3 * leaf + k]);
  if (level === 0) planes.narrow((leaf) => Math.round(OPACITY_STEPS * opacities[leaf]));
  else {
    const steps = BLOB_OPACITY_STEPS / Math.log1p(LEVEL_CONSTANTS.MOST_OPACITY);
    planes.wide((leaf) => Math.round(steps * Math.log1p(opacities[leaf])));
    for (let k = 0; k < 2; k++) planes.differences((leaf) => sumCode(sums[2 * leaf + k]));
  }
  return planes.bytes;
}

function columnsOf(brick: Brick, count: number) {
  const ranges = brick.cells.map(({ logScales: [min, step] }) => ({ min, step }));
  const read = brick.level === 0 ? leafReader(brick.geometry, ranges) : blobReader(brick.geometry);
  const columns = {
    positions: new Float64Array(3 * count),
    logScales: new Float64Array(3 * count),
    rotations: new Uint8Array(3 * count),
    opacities: new Float64Array(count),
    colors: new Float64Array(3 * count),
    sums: new Float64Array(2 * count),
  };
  const leaf = emptyLeaf();
  for (let i = 0; i < count; i++) {
    read(i, leaf);
    columns.positions.set(leaf.position, 3 * i);
    columns.colors.set(leaf.colorDc, 3 * i);
    columns.sums.set(leaf.sums, 2 * i);
    columns.opacities[i] = leaf.opacity;
    for (let axis = 0; axis < 3; axis++)
      columns.logScales[3 * i + axis] = clampLogScale(Math.log(leaf.scale[axis]));
    putRotation(leaf.rotation, columns.rotations, 3 * i);
  }
  return columns;
}

/**
 * Writes x, y and z of a quaternion. A half turn about one of its own axes leaves a splat
 * unchanged, and moves another component to w. One such turn always makes w the largest component.
 */
function putRotation(rotation: Float64Array, target: Uint8Array, at: number): void {
  const largest = largestComponent(rotation);
  const [w, x, y, z] = rotation;
  const turned = [
    [x, y, z],
    [-w, -z, y],
    [z, -w, -x],
    [-y, x, -w],
  ][largest];
  const sign = rotation[largest] < 0 ? -1 : 1;
  for (let k = 0; k < 3; k++)
    target[at + k] = ROTATION_STEPS + Math.round(sign * ROTATION_STEPS * Math.SQRT2 * turned[k]);
}

/** Code of a sum: its logarithm in steps, or 0 for a sum of 0. */
function sumCode(sum: number): number {
  if (!(sum > 0)) return 0;
  return Math.max(1, Math.min(MOST_SUM, SUM_OF_ONE + Math.round(SUM_STEPS * Math.log(sum))));
}
