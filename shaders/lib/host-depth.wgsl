// Depth as the renderer around the splats stores it.
import layout::HostDepth;

/// What is outside of 0…1 by no more than this is so by rounding alone.
const ROUNDING = 1e-5;

/// Of a point at view depth `depthView` and normalised device coordinates `ndc`, y up. The host computes its own from the
/// same matrix in another order of operations: what rounding puts outside of 0…1 is kept from being clipped, and what is
/// really outside, in front of a mirror's oblique near plane, is not.
fn storedDepth(depthView: f32, ndc: vec2f, hostDepth: HostDepth) -> f32 {
  @if(ORTHOGRAPHIC) let mapped = depthView;
  @if(!ORTHOGRAPHIC && DEPTH_LOGARITHMIC) let mapped = log2(depthView);
  @if(!ORTHOGRAPHIC && !DEPTH_LOGARITHMIC) let mapped = 1.0 / depthView;
  let depth = hostDepth.offset + hostDepth.factor * mapped + dot(hostDepth.slope, ndc);
  let clamped = clamp(depth, 0.0, 1.0);
  return select(depth, clamped, abs(depth - clamped) < ROUNDING);
}

/// Inverse of `storedDepth` in the middle of the picture; also of a cleared, infinitely far depth, which is taken for a
/// very large one.
fn depthViewOf(stored: f32, hostDepth: HostDepth) -> f32 {
  let mapped = (stored - hostDepth.offset) / hostDepth.factor;
  @if(ORTHOGRAPHIC) return mapped;
  @if(!ORTHOGRAPHIC && DEPTH_LOGARITHMIC) return exp2(mapped);
  @if(!ORTHOGRAPHIC && !DEPTH_LOGARITHMIC) return 1.0 / max(mapped, 1e-30);
}
