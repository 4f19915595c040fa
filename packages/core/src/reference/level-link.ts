import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';

const { ERROR_BOUNDLESS, ERROR_SHIFT } = LEVEL_CONSTANTS;
const f32 = new Float32Array(1);
const u32 = new Uint32Array(f32.buffer);

/** Reference of shaders/lib/level-link.wgsl: a link as its parts. */
export interface LevelLink {
  /** Own error and the parent's; ERROR_BOUNDLESS for the parent of a root. */
  readonly error: number;
  readonly parentError: number;
  /** Slot of the parent among the blobs of the cell; 0 for a root. */
  readonly parentSlot: number;
}

export function linkParts(link: number): LevelLink {
  return { error: link & 0xfff, parentError: (link >>> 12) & 0xfff, parentSlot: link >>> 24 };
}

/** Error of a blob: the square of a length, rounded up. */
export function blobError(squaredLength: number): number {
  f32[0] = squaredLength;
  const error = Math.floor((u32[0] + 2 ** ERROR_SHIFT - 1) / 2 ** ERROR_SHIFT);
  return Math.max(1, Math.min(error, ERROR_BOUNDLESS - 1));
}

/** Errors up to this one are not seen where squared lengths up to `squaredLength` are not. */
export function threshold(squaredLength: number): number {
  f32[0] = squaredLength;
  return Math.min(u32[0] >>> ERROR_SHIFT, ERROR_BOUNDLESS - 1);
}

/** Whether a splat has no parent, so that it is drawn at every threshold. Budgets do not count it. */
export function isAlwaysDrawn(link: number): boolean {
  const { error, parentError } = linkParts(link);
  return error === 0 && parentError === ERROR_BOUNDLESS;
}

export function isDrawnAt(link: number, limit: number): boolean {
  const { error, parentError } = linkParts(link);
  return error <= limit && limit < parentError;
}
