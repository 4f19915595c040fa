// Links of splats and blobs: when does a cut through the levels draw one? An error is the square of
// a length, as the top 12 bits of its float32 (its exponent and four bits of its mantissa) so that
// errors compare as integers. A link holds a node's own error, its parent's, and the parent's slot
// among the blobs of its cell. A node is drawn if own error ≤ threshold < parent's error: at any
// threshold, exactly one node is drawn on the path from a splat to the root.
// Reference: reference/level-link.ts.
import constants::ERROR_BOUNDLESS;
import constants::ERROR_SHIFT;
import constants::SHIFT_NONE;

/// Error of a blob: rounded up, at least 1, so that a splat's own error, 0, is less.
fn blobError(squaredLength: f32) -> u32 {
  let bits = bitcast<u32>(squaredLength) + ((1u << ERROR_SHIFT) - 1u);
  return clamp(bits >> ERROR_SHIFT, 1u, ERROR_BOUNDLESS - 1u);
}

/// The threshold below which errors are not seen: rounded down.
fn threshold(squaredLength: f32) -> u32 {
  return min(bitcast<u32>(squaredLength) >> ERROR_SHIFT, ERROR_BOUNDLESS - 1u);
}

/// A threshold as a budget shifts it: sixteen codes are a factor of two.
fn shifted(limit: u32, shift: u32) -> u32 {
  return u32(clamp(i32(limit + shift) - SHIFT_NONE, 0, i32(ERROR_BOUNDLESS) - 1));
}

fn linkOf(error: u32, parentError: u32, parentSlot: u32) -> u32 {
  return error | (parentError << 12u) | (parentSlot << 24u);
}

fn errorOf(link: u32) -> u32 {
  return link & 0xfffu;
}

fn parentErrorOf(link: u32) -> u32 {
  return (link >> 12u) & 0xfffu;
}

fn parentSlotOf(link: u32) -> u32 {
  return link >> 24u;
}

/// Whether a splat has no parent, so that it is drawn at every threshold. Budgets do not count it.
fn isAlwaysDrawn(link: u32) -> bool {
  return errorOf(link) == 0u && parentErrorOf(link) == ERROR_BOUNDLESS;
}

fn isDrawnAt(link: u32, limit: u32) -> bool {
  return errorOf(link) <= limit && limit < parentErrorOf(link);
}
