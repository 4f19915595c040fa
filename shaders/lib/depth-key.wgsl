// Sort depths of splats, mapped to unsigned integers in the same order: the sort compares integers.
// Reference: packages/core/src/data/layout/depth-key.ts.
@if(SHORT_KEYS) import constants::SORT_KEY_BITS;

/// Sort depth of a splat, given its place from the camera: depth, or the square of the distance,
/// which resolves gaps half as wide as the distance does. Its unit is the power of two below
/// `near`, or 1 for a near of 0, so that neither large nor small scenes leave float32's range.
fn sortDepth(toward: vec3f, near: f32) -> f32 {
  @if(!DISTANCE_ORDER) return -toward.z;
  @if(DISTANCE_ORDER) let exponent = bitcast<u32>(near) & 0x7f800000u;
  @if(DISTANCE_ORDER) let scale = select(bitcast<f32>(0x7f000000u - exponent), 1.0, exponent == 0u);
  @if(DISTANCE_ORDER) let units = min(abs(toward) * scale, vec3f(1e19));
  @if(DISTANCE_ORDER) return dot(units, units);
}

/// Maps `depthView` (finite) so that orderedBits(a) < orderedBits(b) exactly if a < b, including
/// negative depths (which orthographic cameras have).
fn orderedBits(depthView: f32) -> u32 {
  let given = bitcast<u32>(depthView);
  // −0 and +0 share one key. This compares bits: some compilers drop an addition of +0.
  let bits = select(given, 0u, (given & 0x7fffffffu) == 0u);
  return bits ^ select(0x80000000u, 0xffffffffu, (bits & 0x80000000u) != 0u);
}

/// Sort key: far first, 0 for the farthest splat in the frame. Two shaders may compute one depth an
/// ulp apart (either may be compiled to fused operations), so a depth beyond the farthest must not
/// wrap around to the nearest.
fn depthKey(depthView: f32, farthestBits: u32) -> u32 {
  return farthestBits - min(farthestBits, orderedBits(depthView));
}

/// Top SORT_KEY_BITS bits of that key, counted within the frame's range of depths. A depth an ulp
/// nearer than the nearest counts as the nearest; otherwise its key would be one bit too long.
@if(SHORT_KEYS)
fn shortDepthKey(depthView: f32, farthestBits: u32, nearestBits: u32) -> u32 {
  let range = farthestBits - nearestBits;
  let rangeBits = 32u - countLeadingZeros(range);
  return min(range, depthKey(depthView, farthestBits)) >> (max(rangeBits, SORT_KEY_BITS) - SORT_KEY_BITS);
}
