// Soft edges of the effects volumes, fog and reveal. Reference: reference/effects/edge-fade.ts.

/// 0 up to an edge, 1 from `width` beyond it, smooth in between. A width of 0 makes a hard edge.
fn edgeFade(clearance: f32, width: f32) -> f32 {
  if (clearance <= 0.0) { return 0.0; }
  if (clearance >= width) { return 1.0; }
  let t = clearance / width;
  return t * t * (3.0 - 2.0 * t);
}
