// Projects a splat's Gaussian to the screen, numerically stable by construction. Reference:
// reference/covariance.ts.
import layout::View;

/// Covariance on the screen in units of unitPx², [[a, b], [b, c]], dilation included.
struct ScreenCovariance {
  a: f32,
  b: f32,
  c: f32,
  /// In units of unitPx⁴.
  determinant: f32,
  /// A power of two.
  unitPx: f32,
  /// The determinant without dilation, in units of unitPx⁴.
  @if(OPACITY_EFFECTS) undilatedDeterminant: f32,
}

/// Half axes at √2 standard deviations, where the Gaussian is 1/e, perpendicular.
struct ScreenAxes {
  majorPx: vec2f,
  minorLengthPx: f32,
}

/// Rotation matrix of the unit quaternion w, x, y, z (in that order in `q`).
fn rotationMatrix(q: vec4f) -> mat3x3f {
  let w = q.x;
  let v = q.yzw;
  let wv = 2.0 * w * v;
  let vv = 2.0 * v * v;
  let xy = 2.0 * v.x * v.y;
  let xz = 2.0 * v.x * v.z;
  let yz = 2.0 * v.y * v.z;
  return mat3x3f(
    1.0 - vv.y - vv.z, xy + wv.z, xz - wv.y,
    xy - wv.z, 1.0 - vv.x - vv.z, yz + wv.x,
    xz + wv.y, yz - wv.x, 1.0 - vv.x - vv.y,
  );
}

/// Covariance on the screen of a splat at `centerView` whose local axes, one standard deviation
/// long, are the columns of `axesView` in view space; `dilationPx2` is added to both variances.
fn screenCovariance(view: View, dilationPx2: f32, centerView: vec3f, axesView: mat3x3f) -> ScreenCovariance {
  let axesRows = transpose(axesView);
  @if(ORTHOGRAPHIC) let rowX = view.focalPx.x * axesRows[0];
  @if(ORTHOGRAPHIC) let rowY = -view.focalPx.y * axesRows[1];
  // The clamp limits the affine approximation outside the image, where it grows without bound.
  @if(!ORTHOGRAPHIC) let inverseDepth = -1.0 / centerView.z;
  @if(!ORTHOGRAPHIC) let tangentX = clamp(centerView.x * inverseDepth, view.clampX.x, view.clampX.y);
  @if(!ORTHOGRAPHIC) let tangentY = clamp(centerView.y * inverseDepth, view.clampY.x, view.clampY.y);
  @if(!ORTHOGRAPHIC) let rowX = (view.focalPx.x * inverseDepth) * (axesRows[0] + tangentX * axesRows[2]);
  @if(!ORTHOGRAPHIC) let rowY = (-view.focalPx.y * inverseDepth) * (axesRows[1] + tangentY * axesRows[2]);

  // The determinant, a length's fourth power, overflows early: the unit is a power of two of px.
  let largest = max(max3(abs(rowX)), max3(abs(rowY)));
  let unitPx = bitcast<f32>(bitcast<u32>(max(1.0, largest)) & 0x7f800000u);
  let x = rowX / unitPx;
  let y = rowY / unitPx;
  let dilation = dilationPx2 / unitPx / unitPx;
  let xx = dot(x, x);
  let yy = dot(y, y);
  // By Lagrange's identity the determinant is a sum of non-negative terms: nothing cancels.
  let normal = cross(x, y);
  let undilated = dot(normal, normal);
  let determinant = undilated + dilation * (xx + yy) + dilation * dilation;
  @if(!OPACITY_EFFECTS) return ScreenCovariance(xx + dilation, dot(x, y), yy + dilation, determinant, unitPx);
  @if(OPACITY_EFFECTS) return ScreenCovariance(xx + dilation, dot(x, y), yy + dilation, determinant, unitPx, undilated);
}

/// Longest axis: constant in float32 across any image, and squares of lengths stay in range.
const LONGEST_AXIS_PX = 1e18;

fn screenAxes(covariance: ScreenCovariance, dilationPx2: f32) -> ScreenAxes {
  let a = covariance.a;
  let b = covariance.b;
  let c = covariance.c;
  let halfDifference = 0.5 * (a - c);
  let larger = 0.5 * (a + c) + sqrt(halfDifference * halfDifference + b * b);
  let smaller = covariance.determinant / larger;
  // Both are eigenvectors of the larger eigenvalue; the longer one is better conditioned.
  let first = vec2f(b, larger - a);
  let second = vec2f(larger - c, b);
  let direction = select(second, first, dot(first, first) > dot(second, second));
  let length2 = dot(direction, direction);
  // Both vanish for a circle; its axes may point anywhere.
  let unit = select(vec2f(1.0, 0.0), direction * inverseSqrt(max(length2, 1e-37)), length2 > 1e-37);
  // Dilation makes every axis at least this long; where unitPx² leaves float32's range, the
  // determinant loses that.
  let shortestPx = sqrt(2.0 * dilationPx2);
  return ScreenAxes(
    unit * min(sqrt(2.0 * larger) * covariance.unitPx, LONGEST_AXIS_PX),
    clamp(sqrt(2.0 * smaller) * covariance.unitPx, shortestPx, LONGEST_AXIS_PX),
  );
}

fn max3(v: vec3f) -> f32 {
  return max(v.x, max(v.y, v.z));
}
