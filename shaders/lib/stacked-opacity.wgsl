// The opacity of merged splats: one of opacity above 1 stands for that many opaque splats, one
// behind the other. Linked only where merged splats are drawn, per fragment and for each splat's
// reach. Far from the middle of a splat, 1 − x would cancel the digits that count, so series take
// over: the opacity is then within 5e-6 of its value on any GPU, and splats end where their reach
// does. Reference: reference/stacked-opacity.ts.

/// Opacity of a splat where its Gaussian is `gaussian`, 0…1: 1 − (1 − gaussian)^opacity of a merged
/// one.
fn stackedAlpha(opacity: f32, gaussian: f32) -> f32 {
  @if(!NARROW) if (opacity <= 1.0) { return opacity * gaussian; }
  @if(!NARROW) return opaqueShare(opacity * opticalDepth(gaussian));
  // Drivers for the CPU run both sides of a branch, but no turn of a loop that no thread needs.
  @if(NARROW) var alpha = opacity * gaussian;
  @if(NARROW) let turns = u32(opacity > 1.0);
  @if(NARROW) for (var turn = 0u; turn < turns; turn++) { alpha = opaqueShare(opacity * opticalDepth(gaussian)); }
  @if(NARROW) return alpha;
}

/// Part of a stack's loss of light that its opacity keeps, fitted to pictures of blobs from afar.
const STACK_LOSS = 0.5;

/// Opacity of a splat that is spread over 1/`share` times its area, so that its light stays. A stack
/// loses less: its splats do not lie exactly behind each other, so that each covers a part of the
/// others' pixels.
fn thinnedOpacity(opacity: f32, share: f32) -> f32 {
  if (opacity <= 1.0) { return share * opacity; }
  return share * pow(opacity, 1.0 - STACK_LOSS * (1.0 - share));
}

/// Value of the Gaussian at which a merged splat, of opacity above 1, has fallen to the cutoff.
fn cutoffGaussian(opacity: f32, alphaCutoff: f32) -> f32 {
  return opaqueShare(opticalDepth(alphaCutoff) / opacity);
}

/// Below this, series err by less than 6e-7 of their value.
const SERIES_END = 0.125;

/// −ln(1 − alpha): adds up where splats lie behind each other. 69 instead of infinity at 1.
fn opticalDepth(alpha: f32) -> f32 {
  let tail = 1.0 / 3.0 + alpha * (0.25 + alpha * (0.2 + alpha * (1.0 / 6.0)));
  let series = alpha * (1.0 + alpha * (0.5 + alpha * tail));
  return select(-log(max(1.0 - alpha, 1e-30)), series, alpha < SERIES_END);
}

/// 1 − e^−depth.
fn opaqueShare(depth: f32) -> f32 {
  let tail = 1.0 / 6.0 - depth * (1.0 / 24.0 - depth * (1.0 / 120.0));
  let series = depth * (1.0 - depth * (0.5 - depth * tail));
  return select(1.0 - exp(-depth), series, depth < SERIES_END);
}
