// Tests of chunks against the frustum.

/// Float32 rounding of the test against a side of the frustum, relative to its largest term; far
/// above 6e-8 times the few operations.
const ROUNDING_SLACK = 1e-5;

/// Bounds of the centres of a chunk's splats, about the cloud's origin.
struct ChunkBounds {
  minPosition: vec3f,
  maxPosition: vec3f,
}

/// Whether splats in a box, which reach `reach` beyond their centres, can reach past a side of the
/// frustum into it.
fn reachesPast(side: vec4f, reach: f32, center: vec3f, halfExtent: vec3f) -> bool {
  // How far a splat at the box's best corner still reaches past this side of the frustum.
  let farthest = dot(abs(side.xyz), halfExtent) + reach;
  let slack = ROUNDING_SLACK * (dot(abs(side.xyz), abs(center)) + farthest + abs(side.w));
  return dot(side.xyz, center) + side.w + farthest + slack >= 0.0;
}
