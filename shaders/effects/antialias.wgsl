// Takes back the light that dilation adds: opacity × √(determinant without dilation / determinant with it).
import package::lib::visible_ellipse::ScreenSplat;

fn compensateDilation(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32) -> f32 {
  let covariance = onScreen.covariance;
  // Of a needle beyond 1e18 px, where both determinants leave float32's range, nothing is known but that it is thin.
  if (!(covariance.determinant > 1e-37)) { return 0.0; }
  return opacity * sqrt(min(1.0, covariance.undilatedDeterminant / covariance.determinant));
}
