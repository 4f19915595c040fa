import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { clampCoefficient, toHalfBits } from '../../data/layout/half.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { logScalesOf } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, type PackedGeometry, packRotation } from '../../data/packing/geometry.ts';
import {
  clampLogScale,
  type LogScaleRange,
  logScaleRange,
  logScaleSteps,
} from '../../data/packing/log-scale.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { normalizedRotation } from '../../data/packing/rotation.ts';
import { EDITED, type EditedBlock, placeInBlock, type SplatEdits } from './splat-edits.data.ts';

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
 * Packs splats `from` up to but not including `to` with their edits. Unedited values keep their
 * bits, unless `f32` geometry is packed as `packed`, or the range of a splat's chunk has changed.
 *
 * @param precision precision of the source geometry, or a coarser one.
 * @param chunks with the ranges of log scales for `packed`.
 */
export function packEdited(
  splats: EditedGeometry,
  from: number,
  to: number,
  precision: GeometryPrecision,
  chunks: Float32Array,
): Uint32Array<ArrayBuffer> {
  const { geometry, origin, fileIndices, edits } = splats;
  const stride = GEOMETRY_WORDS[geometry.precision];
  const words = geometry.words.slice(from * stride, to * stride);
  const floats = new Float32Array(words.buffer);
  for (let i = from; i < to; i++) {
    const at = stride * (i - from);
    const before = logScalesOf(geometry.chunks, chunkOf(i));
    const range = logScalesOf(chunks, chunkOf(i));
    if (geometry.precision === 'packed' && !isSameRange(before, range)) changeRange(words, at, before, range);
    const row = fileIndices[i];
    const block = edits.blockOf(row);
    if (!block) continue;
    const place = placeInBlock(row);
    if (geometry.precision === 'f32') editF32(floats, at, origin, block, place);
    else editPacked(words, floats, at, origin, block, place, range);
  }
  return precision === geometry.precision ? words : packF32(floats, from, to, chunks);
}

function move(floats: Float32Array, at: number, origin: Vec3, positions: Float64Array, place: number): void {
  floats[at] = positions[3 * place] - origin[0];
  floats[at + 1] = positions[3 * place + 1] - origin[1];
  floats[at + 2] = positions[3 * place + 2] - origin[2];
}

function editF32(floats: Float32Array, at: number, origin: Vec3, block: EditedBlock, place: number): void {
  const mask = block.masks[place];
  const { positions, scales, rotations, opacities, colors } = block;
  if (mask & EDITED.positions) move(floats, at, origin, positions!, place);
  if (mask & EDITED.opacities) floats[at + 3] = opacities![place];
  if (mask & EDITED.hidden) floats[at + 3] = 0;
  if (mask & EDITED.rotations) {
    normalizedRotation(rotations!, 4 * place, rotation);
    floats.set(rotation, at + 4);
  }
  if (mask & EDITED.scales)
    for (let axis = 0; axis < 3; axis++)
      floats[at + 8 + axis] = Math.exp(clampLogScale(scales![3 * place + axis]));
  if (mask & EDITED.colors)
    for (let k = 0; k < 3; k++) floats[at + 12 + k] = clampCoefficient(colors![3 * place + k]);
}

function editPacked(
  words: Uint32Array,
  floats: Float32Array,
  at: number,
  origin: Vec3,
  block: EditedBlock,
  place: number,
  range: LogScaleRange,
): void {
  const mask = block.masks[place];
  const { positions, scales, rotations, opacities, colors } = block;
  if (mask & EDITED.positions) move(floats, at, origin, positions!, place);
  if (mask & EDITED.colors) {
    words[at + 3] = toHalfBits(colors![3 * place]) | (toHalfBits(colors![3 * place + 1]) << 16);
    words[at + 4] = (words[at + 4] & 0xffff0000) | toHalfBits(colors![3 * place + 2]);
  }
  if (mask & EDITED.opacities)
    words[at + 4] = (words[at + 4] & 0xffff) | (opacitySteps(opacities![place]) << 16);
  if (mask & EDITED.hidden) words[at + 4] &= 0xffff;
  if (mask & EDITED.scales) {
    const y = logScaleSteps(scales![3 * place + 1], range);
    words[at + 5] = logScaleSteps(scales![3 * place], range) | (y << 16);
    words[at + 6] = (words[at + 6] & 0xffff0000) | logScaleSteps(scales![3 * place + 2], range);
  }
  if (mask & EDITED.rotations) {
    normalizedRotation(rotations!, 4 * place, rotation);
    const [low, high] = packRotation(rotation);
    words[at + 6] = (words[at + 6] & 0xffff) | (low << 16);
    words[at + 7] = high;
  }
}

/** Like the stage `repack-geometry`, except that quantised values may differ by one step. */
function packF32(
  floats: Float32Array,
  first: number,
  end: number,
  chunks: Float32Array,
): Uint32Array<ArrayBuffer> {
  const words = new Uint32Array((end - first) * GEOMETRY_WORDS.packed);
  for (let i = 0; i < end - first; i++) {
    const from = GEOMETRY_WORDS.f32 * i;
    const at = GEOMETRY_WORDS.packed * i;
    for (let axis = 0; axis < 3; axis++) words[at + axis] = bitsOf(floats[from + axis]);
    for (let k = 0; k < 4; k++) rotation[k] = floats[from + 4 + k];
    const range = logScalesOf(chunks, chunkOf(first + i));
    const [x, y, z] = [8, 9, 10].map((k) => logScaleSteps(Math.log(floats[from + k]), range));
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
  target: Float32Array,
): void {
  const row = fileIndices[index];
  const block = edits.blockOf(row);
  const place = placeInBlock(row);
  if (block && block.masks[place] & EDITED.positions) move(target, 0, origin, block.positions!, place);
  else {
    const at = GEOMETRY_WORDS[geometry.precision] * index;
    for (let axis = 0; axis < 3; axis++) target[axis] = floats[at + axis];
  }
}

/** The range of a chunk's log scales: that before edits, or a wider one if edits leave that. */
export function editedLogScales(
  { geometry, fileIndices, edits }: EditedGeometry,
  chunk: number,
): LogScaleRange {
  const before = logScalesOf(geometry.chunks, chunk);
  const high = before.min + 65535 * before.step;
  let smallest = before.min;
  let largest = high;
  const first = chunk * CHUNK_SPLATS;
  for (const row of fileIndices.subarray(first, first + CHUNK_SPLATS)) {
    if (!(edits.maskOf(row) & EDITED.scales)) continue;
    for (const each of edits.valuesOf(row, 'scales')) {
      smallest = Math.min(smallest, clampLogScale(each));
      largest = Math.max(largest, clampLogScale(each));
    }
  }
  // Half a step beyond is rounded back.
  const margin = before.step / 2;
  const isInside = smallest >= before.min - margin && largest <= high + margin;
  return isInside ? before : logScaleRange(smallest, largest);
}

export function isSameRange(a: LogScaleRange, b: LogScaleRange): boolean {
  return a.min === b.min && a.step === b.step;
}

function chunkOf(splat: number): number {
  return Math.floor(splat / CHUNK_SPLATS);
}

/** Gives a packed splat's log scales in steps of another range. */
function changeRange(words: Uint32Array, at: number, { min, step }: LogScaleRange, to: LogScaleRange): void {
  const moved = (steps: number) => logScaleSteps(min + step * steps, to);
  words[at + 5] = moved(words[at + 5] & 0xffff) | (moved(words[at + 5] >>> 16) << 16);
  words[at + 6] = (words[at + 6] & 0xffff0000) | moved(words[at + 6] & 0xffff);
}
