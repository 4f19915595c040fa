// Depth as the renderer around the splats stores it.
import layout::HostDepth;

/// Of a point at view depth `depthView`; the host computes its own from the same matrix in another order of operations,
/// and what rounding puts outside of 0…1 would be clipped.
fn storedDepth(depthView: f32, hostDepth: HostDepth) -> f32 {
  @if(ORTHOGRAPHIC) let mapped = depthView;
  @if(!ORTHOGRAPHIC && DEPTH_LOGARITHMIC) let mapped = log2(depthView);
  @if(!ORTHOGRAPHIC && !DEPTH_LOGARITHMIC) let mapped = 1.0 / depthView;
  return clamp(hostDepth.offset + hostDepth.factor * mapped, 0.0, 1.0);
}
