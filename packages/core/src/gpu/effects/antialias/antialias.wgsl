// Effect `antialias`: removes the light that dilation adds. Runs per splat in cull-splats and
// project. Reads a splat's opacity and its covariance on the screen; returns opacity ×
// √(determinant without dilation / with it), and of a stack (opacity above 1) less.
import package::lib::stacked_opacity::thinnedOpacity;
import package::lib::visible_ellipse::ScreenSplat;

fn compensateDilation(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32) -> f32 {
  let covariance = onScreen.covariance;
  // Both determinants of a needle beyond 1e18 px leave float32's range: it is thin.
  if (!(covariance.determinant > 1e-37)) { return 0.0; }
  return thinnedOpacity(opacity, sqrt(min(1.0, covariance.undilatedDeterminant / covariance.determinant)));
}
