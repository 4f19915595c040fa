// Splats as merging sees them: Gaussians with a weight, in units of their cell. Used by the merging
// stages. Reference: reference/merged-splat.ts.
import package::lib::covariance::rotationMatrix;
import package::lib::packing::Splat;

/// A splat or a blob in units of its cell, a power of two.
struct Merged {
  center: vec3f,
  /// Opacity times mean area.
  weight: f32,
  /// Covariance: xx, yy, zz and yz, xz, xy.
  variance: vec3f,
  covariance: vec3f,
  /// Base colour.
  color: vec3f,
}

const LEAST_OPACITY = 1e-6;
const LEAST_AREA = 1e-30;

/// Mean area of an ellipsoid's projections over π, by Thomsen's formula, of its half axes.
fn meanArea(axes: vec3f) -> f32 {
  let products = max(axes.yzx * axes.zxy, vec3f(1e-24));
  let mean = dot(pow(products, vec3f(1.6075)), vec3f(1.0 / 3.0));
  return max(pow(mean, 1.0 / 1.6075), LEAST_AREA);
}

/// How far the area of a disc or needle grows with each pixel of its rim, besides `meanArea`.
fn rimLength(axes: vec3f, area: f32) -> f32 {
  let longest = max(axes.x, max(axes.y, axes.z));
  return max(0.0, longest - area / max(longest, 1e-15));
}

/// Opacity times mean area; not 0, so that shares are defined of splats that nothing shows.
fn weightOf(opacity: f32, axes: vec3f) -> f32 {
  return max(opacity, LEAST_OPACITY) * meanArea(axes);
}

fn mergedOf(splat: Splat, perUnit: f32) -> Merged {
  let rotation = rotationMatrix(splat.rotation);
  let axes = splat.scale * perUnit;
  let x = rotation[0] * axes.x;
  let y = rotation[1] * axes.y;
  let z = rotation[2] * axes.z;
  return Merged(
    splat.position * perUnit,
    weightOf(splat.opacity, axes),
    x * x + y * y + z * z,
    x.yxx * x.zzy + y.yxx * y.zzy + z.yxx * z.zzy,
    splat.colorDc,
  );
}

/// Cost of merging two splats (Ward's criterion): the moved weight times the squared distance. A
/// difference of colour adds to the distance, in proportion to the merged extent.
fn mergeCost(a: Merged, b: Merged) -> f32 {
  let weight = a.weight + b.weight;
  let share = a.weight / weight;
  let moved = share * (1.0 - share);
  let apart = a.center - b.center;
  let distance2 = dot(apart, apart);
  let contrast = COLOR_OF_DC * (a.color - b.color);
  let trace = dot(share * a.variance + (1.0 - share) * b.variance, vec3f(1.0)) + moved * distance2;
  // Finite, so that costs always have an order.
  return min(12.566370614359172 * weight * moved * (distance2 + trace * dot(contrast, contrast)), 1e37);
}

/// Spherical harmonics of degree 0.
const COLOR_OF_DC = 0.28209479177387814;

/// The Gaussian with the same mean and covariance as both together.
fn merge(a: Merged, b: Merged) -> Merged {
  let weight = a.weight + b.weight;
  let share = a.weight / weight;
  let rest = 1.0 - share;
  let apart = a.center - b.center;
  let moved = share * rest;
  return Merged(
    // Coordinates that both share stay as they are, however far out.
    a.center - rest * apart,
    weight,
    share * a.variance + rest * b.variance + moved * apart * apart,
    share * a.covariance + rest * b.covariance + moved * apart.yxx * apart.zzy,
    share * a.color + rest * b.color,
  );
}

/// A covariance as rotation and half axes.
struct Shape {
  rotation: vec4f,
  scale: vec3f,
}

/// Sweeps of Jacobi's method: the off-diagonal part of 3×3 matrices is below rounding after these.
const SWEEPS = 5u;

fn shapeOf(blob: Merged) -> Shape {
  var d = blob.variance;
  var o = blob.covariance;
  var q = vec4f(1.0, 0.0, 0.0, 0.0);
  for (var sweep = 0u; sweep < SWEEPS; sweep++) {
    // In the plane of x and y, then x and z, then y and z.
    let xy = turn(d.x, d.y, o.z);
    d += vec3f(-xy.x * o.z, xy.x * o.z, 0.0);
    o = vec3f(xy.z * o.y + xy.y * o.x, xy.y * o.y - xy.z * o.x, 0.0);
    q = turned(q, vec3f(0.0, 0.0, -1.0), xy);
    let xz = turn(d.x, d.z, o.y);
    d += vec3f(-xz.x * o.y, 0.0, xz.x * o.y);
    o = vec3f(xz.z * o.z + xz.y * o.x, 0.0, xz.y * o.z - xz.z * o.x);
    q = turned(q, vec3f(0.0, 1.0, 0.0), xz);
    let yz = turn(d.y, d.z, o.x);
    d += vec3f(0.0, -yz.x * o.x, yz.x * o.x);
    o = vec3f(0.0, yz.z * o.z + yz.y * o.y, yz.y * o.z - yz.z * o.y);
    q = turned(q, vec3f(-1.0, 0.0, 0.0), yz);
  }
  return Shape(normalize(q), sqrt(max(d, vec3f(1e-30))));
}

/// Tangent, cosine and sine of the turn that takes away the covariance of two axes.
fn turn(first: f32, second: f32, covariance: f32) -> vec3f {
  if (abs(covariance) < 1e-36) { return vec3f(0.0, 1.0, 0.0); }
  let ratio = clamp((second - first) / (2.0 * covariance), -1e15, 1e15);
  let tangent = select(-1.0, 1.0, ratio >= 0.0) / (abs(ratio) + sqrt(1.0 + ratio * ratio));
  let cosine = inverseSqrt(1.0 + tangent * tangent);
  return vec3f(tangent, cosine, tangent * cosine);
}

/// Turns a rotation further, by the angle of `by` about an axis of its own.
fn turned(q: vec4f, axis: vec3f, by: vec3f) -> vec4f {
  let w = sqrt(0.5 + 0.5 * by.y);
  let v = axis * (0.5 * by.z / w);
  return vec4f(q.x * w - dot(q.yzw, v), q.x * v + w * q.yzw + cross(q.yzw, v));
}
