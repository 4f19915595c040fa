// Effect `antialias`: removes the light that dilation adds. Runs per splat in cull-splats and
// project. Reads a splat's opacity and its covariance on the screen; returns opacity ×
// √(determinant without dilation / with it), and of a stack (opacity above 1) less: its splats do
// not lie exactly behind each other, so that each covers a part of the others' pixels. How much less
// was fitted to pictures of blobs from afar.
import package::lib::visible_ellipse::ScreenSplat;

const STACK_LOSS = 0.5;

fn compensateDilation(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32) -> f32 {
  let covariance = onScreen.covariance;
  // Both determinants of a needle beyond 1e18 px leave float32's range: it is thin.
  if (!(covariance.determinant > 1e-37)) { return 0.0; }
  let share = sqrt(min(1.0, covariance.undilatedDeterminant / covariance.determinant));
  if (opacity <= 1.0) { return share * opacity; }
  return share * pow(opacity, 1.0 - STACK_LOSS * (1.0 - share));
}
