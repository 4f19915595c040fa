// Effect `depth-of-field`: spreads the light of a splat over the circle of confusion of its depth. Runs
// per splat in cull-splats and project. The circle is a disc of even light; its variance along each
// axis, radius²/4, is added to the splat's covariance. Opacity × √(determinant before / after) keeps
// the light.
import package::lib::covariance::ScreenCovariance;
import package::lib::stacked_opacity::thinnedOpacity;
import package::lib::visible_ellipse::ScreenSplat;
import parameters::DepthOfField;

/// Largest circle of confusion: the product of two variances is still far within float32.
const MOST_PX = 1e6;

fn spreadByLens(onScreen: ScreenSplat, parameters: DepthOfField) -> ScreenSplat {
  let blur = lensBlur(onScreen, parameters);
  var spread = onScreen;
  spread.covariance.a += blur.x;
  spread.covariance.c += blur.y;
  spread.covariance.determinant = spreadDeterminant(onScreen.covariance, blur);
  return spread;
}

fn keepLight(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32, parameters: DepthOfField) -> f32 {
  let covariance = onScreen.covariance;
  let determinant = spreadDeterminant(covariance, lensBlur(onScreen, parameters));
  // Of a splat so long that float32 loses its width, both are 0.
  if (!(determinant > 1e-37)) { return opacity; }
  return thinnedOpacity(opacity, sqrt(min(1.0, covariance.determinant / determinant)));
}

/// Variances of the circle of confusion along x and y, in units of the covariance.
fn lensBlur(onScreen: ScreenSplat, parameters: DepthOfField) -> vec2f {
  let depth = onScreen.depthView;
  let defocus = abs(depth - parameters.focusDistance) / parameters.focusDistance;
  let depths = select(1.0, depth, parameters.isPerspective == 1u);
  let radiusPx = min(parameters.aperturePx * (defocus / depths), vec2f(MOST_PX));
  let deviation = 0.5 * radiusPx / onScreen.covariance.unitPx;
  return deviation * deviation;
}

/// A sum of non-negative terms: nothing cancels.
fn spreadDeterminant(covariance: ScreenCovariance, blur: vec2f) -> f32 {
  return covariance.determinant + blur.x * covariance.c + blur.y * covariance.a + blur.x * blur.y;
}
