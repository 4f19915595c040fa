import { clampCoefficient, toHalfBits } from '../layout/half.ts';
import type { Vec3 } from '../math/mat4.ts';
import { EDITED, type SplatEdits } from '../splats/splat-edits.ts';
import {
  GEOMETRY_WORDS,
  type LogScaleRange,
  logScaleSteps,
  type PackedGeometry,
  packRotation,
} from './geometry.ts';
import { clampLogScale } from './log-scale.ts';
import type { GeometryPrecision } from './precision.ts';
import { normalizedRotation } from './rotation.ts';

const values = new Float64Array(4);
const rotation = new Float64Array(4);
const f32 = new Float32Array(1);
const f32Bits = new Uint32Array(f32.buffer);

/** The geometry of splats as they were before any edit, and their edits. */
export interface EditedGeometry {
  readonly geometry: PackedGeometry;
  /** The words of `geometry` as float32. */
  readonly floats: Float32Array;
  readonly origin: Vec3;
  /** Row of each splat. */
  readonly fileIndices: Uint32Array;
  readonly edits: SplatEdits;
}

export function editedGeometry(
  geometry: PackedGeometry,
  origin: Vec3,
  fileIndices: Uint32Array,
  edits: SplatEdits,
): EditedGeometry {
  const { words } = geometry;
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  return { geometry, floats, origin, fileIndices, edits };
}

/**
 * Packs splats `from` up to but not including `to` with their edits. What was not edited keeps its bits, unless it is packed as
 * `packed` from `f32`.
 *
 * @param precision that of the geometry, or a coarser one.
 * @param range of log scales, for `packed`.
 */
export function packEdited(
  splats: EditedGeometry,
  from: number,
  to: number,
  precision: GeometryPrecision,
  range: LogScaleRange,
): Uint32Array<ArrayBuffer> {
  const { geometry, fileIndices, edits } = splats;
  const stride = GEOMETRY_WORDS[geometry.precision];
  const words = geometry.words.slice(from * stride, to * stride);
  const floats = new Float32Array(words.buffer);
  for (let i = from; i < to; i++) {
    const mask = edits.maskOf(fileIndices[i]);
    if (mask === 0) continue;
    const at = stride * (i - from);
    if (geometry.precision === 'f32') editF32(floats, at, splats, fileIndices[i], mask);
    else editPacked(words, floats, at, splats, fileIndices[i], mask, range);
  }
  return precision === geometry.precision ? words : packF32(floats, to - from, range);
}

function editF32(
  floats: Float32Array,
  at: number,
  { edits, origin }: EditedGeometry,
  row: number,
  mask: number,
): void {
  if (mask & EDITED.positions) {
    edits.read(row, 'positions', values);
    for (let axis = 0; axis < 3; axis++) floats[at + axis] = values[axis] - origin[axis];
  }
  if (mask & EDITED.opacities) {
    edits.read(row, 'opacities', values);
    floats[at + 3] = values[0];
  }
  if (mask & EDITED.hidden) floats[at + 3] = 0;
  if (mask & EDITED.rotations) {
    edits.read(row, 'rotations', values);
    normalizedRotation(values, 0, rotation);
    floats.set(rotation, at + 4);
  }
  if (mask & EDITED.scales) {
    edits.read(row, 'scales', values);
    for (let axis = 0; axis < 3; axis++) floats[at + 8 + axis] = Math.exp(clampLogScale(values[axis]));
  }
  if (mask & EDITED.colors) {
    edits.read(row, 'colors', values);
    for (let k = 0; k < 3; k++) floats[at + 12 + k] = clampCoefficient(values[k]);
  }
}

function editPacked(
  words: Uint32Array,
  floats: Float32Array,
  at: number,
  { edits, origin }: EditedGeometry,
  row: number,
  mask: number,
  { min, step }: LogScaleRange,
): void {
  if (mask & EDITED.positions) {
    edits.read(row, 'positions', values);
    for (let axis = 0; axis < 3; axis++) floats[at + axis] = values[axis] - origin[axis];
  }
  if (mask & EDITED.colors) {
    edits.read(row, 'colors', values);
    words[at + 3] = toHalfBits(values[0]) | (toHalfBits(values[1]) << 16);
    words[at + 4] = (words[at + 4] & 0xffff0000) | toHalfBits(values[2]);
  }
  if (mask & EDITED.opacities) {
    edits.read(row, 'opacities', values);
    words[at + 4] = (words[at + 4] & 0xffff) | (opacitySteps(values[0]) << 16);
  }
  if (mask & EDITED.hidden) words[at + 4] &= 0xffff;
  if (mask & EDITED.scales) {
    edits.read(row, 'scales', values);
    const [x, y, z] = [0, 1, 2].map((axis) => logScaleSteps(values[axis], min, step));
    words[at + 5] = x | (y << 16);
    words[at + 6] = (words[at + 6] & 0xffff0000) | z;
  }
  if (mask & EDITED.rotations) {
    edits.read(row, 'rotations', values);
    normalizedRotation(values, 0, rotation);
    const [low, high] = packRotation(rotation);
    words[at + 6] = (words[at + 6] & 0xffff) | (low << 16);
    words[at + 7] = high;
  }
}

/** What `repack-geometry` makes of splats, but that steps may be one beside those in float32. */
function packF32(
  floats: Float32Array,
  count: number,
  { min, step }: LogScaleRange,
): Uint32Array<ArrayBuffer> {
  const words = new Uint32Array(count * GEOMETRY_WORDS.packed);
  for (let i = 0; i < count; i++) {
    const from = GEOMETRY_WORDS.f32 * i;
    const at = GEOMETRY_WORDS.packed * i;
    for (let axis = 0; axis < 3; axis++) words[at + axis] = bitsOf(floats[from + axis]);
    for (let k = 0; k < 4; k++) rotation[k] = floats[from + 4 + k];
    const [x, y, z] = [8, 9, 10].map((k) => logScaleSteps(Math.log(floats[from + k]), min, step));
    const [low, high] = packRotation(rotation);
    words[at + 3] = toHalfBits(floats[from + 12]) | (toHalfBits(floats[from + 13]) << 16);
    words[at + 4] = toHalfBits(floats[from + 14]) | (opacitySteps(floats[from + 3]) << 16);
    words[at + 5] = x | (y << 16);
    words[at + 6] = z | (low << 16);
    words[at + 7] = high;
  }
  return words;
}

function opacitySteps(opacity: number): number {
  return Math.round(opacity * 65535);
}

function bitsOf(value: number): number {
  f32[0] = value;
  return f32Bits[0];
}

/** Writes where a splat is about the cloud's origin, as edited, to `target`. */
export function editedPosition(
  { geometry, floats, origin, fileIndices, edits }: EditedGeometry,
  index: number,
  target: Float64Array,
): void {
  const row = fileIndices[index];
  if (edits.maskOf(row) & EDITED.positions) {
    edits.read(row, 'positions', target);
    for (let axis = 0; axis < 3; axis++) target[axis] = Math.fround(target[axis] - origin[axis]);
    return;
  }
  const at = GEOMETRY_WORDS[geometry.precision] * index;
  for (let axis = 0; axis < 3; axis++) target[axis] = floats[at + axis];
}

/** The largest log scale of a splat, as edited. */
export function editedLogScale(
  { geometry, floats, fileIndices, edits }: EditedGeometry,
  index: number,
): number {
  const row = fileIndices[index];
  if (edits.maskOf(row) & EDITED.scales) {
    edits.read(row, 'scales', values);
    return clampLogScale(Math.max(values[0], values[1], values[2]));
  }
  const at = GEOMETRY_WORDS[geometry.precision] * index;
  if (geometry.precision === 'f32')
    return Math.log(Math.max(floats[at + 8], floats[at + 9], floats[at + 10]));
  const { words, logScaleRange } = geometry;
  const steps = Math.max(words[at + 5] & 0xffff, words[at + 5] >>> 16, words[at + 6] & 0xffff);
  return logScaleRange.min + logScaleRange.step * steps;
}

/** The same splats, with log scales in steps of another range. */
export function withLogScaleRange(geometry: PackedGeometry, logScaleRange: LogScaleRange): PackedGeometry {
  if (geometry.precision === 'f32') return { ...geometry, logScaleRange };
  const { min, step } = geometry.logScaleRange;
  const words = geometry.words.slice();
  const moved = (steps: number) => logScaleSteps(min + step * steps, logScaleRange.min, logScaleRange.step);
  for (let at = 0; at < words.length; at += GEOMETRY_WORDS.packed) {
    words[at + 5] = moved(words[at + 5] & 0xffff) | (moved(words[at + 5] >>> 16) << 16);
    words[at + 6] = (words[at + 6] & 0xffff0000) | moved(words[at + 6] & 0xffff);
  }
  return { ...geometry, words, logScaleRange };
}
