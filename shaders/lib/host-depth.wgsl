// Converts between view depths and depths as the host, the renderer around the splats, stores them.
import layout::HostDepth;

/// Depths outside of 0…1 by less than this are so by rounding alone.
const DEPTH_ROUNDING = 1e-5;

/// Stored depth of a point at view depth `depthView` in the middle of the image, before clamping.
fn centralDepth(depthView: f32, hostDepth: HostDepth) -> f32 {
  @if(ORTHOGRAPHIC) let mapped = depthView;
  @if(!ORTHOGRAPHIC && DEPTH_LOGARITHMIC) let mapped = log2(depthView);
  @if(!ORTHOGRAPHIC && !DEPTH_LOGARITHMIC) let mapped = 1.0 / depthView;
  return hostDepth.offset + hostDepth.factor * mapped;
}

/// Stored depth of a point at view depth `depthView` and normalised device coordinates `ndc`, y up.
/// The host computes its own depths from the same matrix in another order of operations. A depth
/// that rounding alone puts outside of 0…1 is therefore clamped, so that it is not clipped; one
/// that is really outside, in front of a mirror's oblique near plane, is left to be clipped.
fn storedDepth(depthView: f32, ndc: vec2f, hostDepth: HostDepth) -> f32 {
  let depth = centralDepth(depthView, hostDepth) + dot(hostDepth.slope, ndc);
  let clamped = clamp(depth, 0.0, 1.0);
  return select(depth, clamped, abs(depth - clamped) < DEPTH_ROUNDING);
}

/// Inverse of `storedDepth` in the middle of the image. Cleared, infinite depths become very large.
fn depthViewOf(stored: f32, hostDepth: HostDepth) -> f32 {
  let mapped = (stored - hostDepth.offset) / hostDepth.factor;
  @if(ORTHOGRAPHIC) return mapped;
  @if(!ORTHOGRAPHIC && DEPTH_LOGARITHMIC) return exp2(mapped);
  @if(!ORTHOGRAPHIC && !DEPTH_LOGARITHMIC) return 1.0 / max(mapped, 1e-30);
}
