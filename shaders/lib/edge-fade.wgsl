// The soft edge of what is cut off. Twin: reference/effects/edge-fade.ts.

/// 0 up to an edge, 1 from `width` beyond it on, smooth between. At a width of 0 a hard edge: nothing is divided by it.
fn edgeFade(clearance: f32, width: f32) -> f32 {
  if (clearance <= 0.0) { return 0.0; }
  if (clearance >= width) { return 1.0; }
  let t = clearance / width;
  return t * t * (3.0 - 2.0 * t);
}
