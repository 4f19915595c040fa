// Depths as unsigned integers in the same order. Twin: packages/core/src/layout/depth-key.ts.
@if(SHORT_KEYS) import constants::SORT_KEY_BITS;

/// Bits of `depthView` (finite) such that a < b exactly where orderedBits(a) < orderedBits(b), negative depths (of an
/// orthographic camera) included.
fn orderedBits(depthView: f32) -> u32 {
  let given = bitcast<u32>(depthView);
  // −0 and +0 give one key. By the bits: adding +0 would do it, but compilers have been seen to leave that out.
  let bits = select(given, 0u, (given & 0x7fffffffu) == 0u);
  return bits ^ select(0x80000000u, 0xffffffffu, (bits & 0x80000000u) != 0u);
}

/// Sort key: far first, 0 for the farthest splat in the picture. Two shaders may compute one depth an ulp apart (either
/// may be compiled to fused operations): what is beyond the farthest must not wrap around to the nearest.
fn depthKey(depthView: f32, farthestBits: u32) -> u32 {
  return farthestBits - min(farthestBits, orderedBits(depthView));
}

/// Of that key the top SORT_KEY_BITS bits of the range of depths in the picture. What is an ulp nearer than the nearest
/// counts as that, or it would be one bit too long.
@if(SHORT_KEYS)
fn shortDepthKey(depthView: f32, farthestBits: u32, nearestBits: u32) -> u32 {
  let range = farthestBits - nearestBits;
  let rangeBits = 32u - countLeadingZeros(range);
  return min(range, depthKey(depthView, farthestBits)) >> (max(rangeBits, SORT_KEY_BITS) - SORT_KEY_BITS);
}
