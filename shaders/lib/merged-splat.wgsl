// Splats as merging sees them: Gaussians with a weight, in units of their cell. Reference:
// reference/merged-splat.ts.
import package::lib::covariance::rotationMatrix;
import package::lib::packing::Splat;

/// A splat or a blob in units of its cell, a power of two.
struct Merged {
  center: vec3f,
  /// Area that its splats cover together, over 2π, averaged over directions.
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

/// Through the corners of an icosahedron: means over these are nearly means over all directions.
const DIRECTIONS = array<vec3f, 6>(
  vec3f(0.0, 0.5257311121, 0.8506508084), vec3f(0.0, 0.5257311121, -0.8506508084),
  vec3f(0.5257311121, 0.8506508084, 0.0), vec3f(0.5257311121, -0.8506508084, 0.0),
  vec3f(0.8506508084, 0.0, 0.5257311121), vec3f(-0.8506508084, 0.0, 0.5257311121),
);
/// Makes the series below 1 for an opacity of 1; 1.2e-3 less than Euler's constant.
const SERIES_START = 0.5760163734;

/// Area that a stack covers, in areas of an opaque splat of its shape: its opacity up to 1, above
/// that the harmonic number, by a series that errs by 1.2e-3.
fn coverOf(opacity: f32) -> f32 {
  let x = max(opacity, 1.0) + 0.5;
  return select(log(x) + 1.0 / (24.0 * x * x) + SERIES_START, opacity, opacity <= 1.0);
}

/// The opacity that covers as much: the inverse of `coverOf`, to float32's rounding.
fn opacityOfCover(cover: f32) -> f32 {
  let logarithm = clamp(cover, 1.0, 60.0) - SERIES_START;
  let first = exp(logarithm);
  let x = first - 1.0 / (24.0 * first);
  // A step of Newton's method.
  let error = log(x) + 1.0 / (24.0 * x * x) - logarithm;
  return select(max(1.0, x - error / (1.0 / x - 1.0 / (12.0 * x * x * x)) - 0.5), cover, cover <= 1.0);
}

/// Mean over the directions of an ellipsoid's footprint; `rotation` has its axes as columns.
fn meanFootprint(rotation: mat3x3f, axes: vec3f) -> f32 {
  let faces = axes.yzx * axes.zxy;
  var sum = 0.0;
  for (var i = 0u; i < 6u; i++) { sum += length(faces * (DIRECTIONS[i] * rotation)); }
  return max(sum / 6.0, LEAST_AREA);
}

/// Area that a splat covers, over 2π; not 0, so that shares are defined of splats that nothing shows.
fn weightOf(opacity: f32, rotation: mat3x3f, axes: vec3f) -> f32 {
  return coverOf(max(opacity, LEAST_OPACITY)) * meanFootprint(rotation, axes);
}

/// Opacity of a blob of this shape that covers what its splats cover.
fn opacityOf(weight: f32, shape: Shape) -> f32 {
  return opacityOfCover(weight / meanFootprint(rotationMatrix(shape.rotation), shape.scale));
}

fn mergedOf(splat: Splat, perUnit: f32) -> Merged {
  let rotation = rotationMatrix(splat.rotation);
  let axes = splat.scale * perUnit;
  let x = rotation[0] * axes.x;
  let y = rotation[1] * axes.y;
  let z = rotation[2] * axes.z;
  return Merged(
    splat.position * perUnit,
    weightOf(splat.opacity, rotation, axes),
    x * x + y * y + z * z,
    x.yxx * x.zzy + y.yxx * y.zzy + z.yxx * z.zzy,
    splat.colorDc,
  );
}

/// How much more a difference of colour costs than the way to its edges, and how much one of shapes.
const COLOR_COST = 3.0;
const SHAPE_COST = 0.25;
/// Differences of shapes below this part of their extent cost nothing: rounding leaves as much.
const SHAPE_ROUNDING = 1e-6;

/// Cost of merging two splats (Ward's criterion): the moved weight times the squared distance. A
/// difference of colour adds to the distance, in proportion to the merged extent, and so does one of
/// shapes.
fn mergeCost(a: Merged, b: Merged) -> f32 {
  let weight = a.weight + b.weight;
  let share = a.weight / weight;
  let moved = share * (1.0 - share);
  let apart = a.center - b.center;
  let distance2 = dot(apart, apart);
  let contrast = COLOR_OF_DC * (a.color - b.color);
  let trace = dot(share * a.variance + (1.0 - share) * b.variance, vec3f(1.0)) + moved * distance2;
  let variance = a.variance - b.variance;
  let covariance = a.covariance - b.covariance;
  let difference = sqrt(dot(variance, variance) + 2.0 * dot(covariance, covariance));
  let shapes = max(0.0, difference - SHAPE_ROUNDING * trace);
  let apart2 = distance2 + COLOR_COST * trace * dot(contrast, contrast) + SHAPE_COST * shapes;
  // Finite, so that costs always have an order.
  return min(12.566370614359172 * weight * moved * apart2, 1e37);
}

/// Spherical harmonics of degree 0.
const COLOR_OF_DC = 0.28209479177387814;

/// Squares of footprints: a covariance's cofactors, by which `nᵀ·cofactors·n` is one.
struct Cofactors {
  variance: vec3f,
  covariance: vec3f,
}

fn cofactorsOf(v: vec3f, c: vec3f) -> Cofactors {
  return Cofactors(v.yzx * v.zxy - c * c, c.yzx * c.zxy - v * c);
}

/// Area of a Gaussian seen along `n`, over 2π.
fn footprint(m: Cofactors, n: vec3f) -> f32 {
  return sqrt(max(0.0, dot(m.variance, n * n) + 2.0 * dot(m.covariance, n.yzx * n.zxy)));
}

/// Area that both cover, over 2π, on average over the directions: seen along each, the integral of
/// the product of both Gaussians, and never more than either has.
fn overlapOf(a: Merged, b: Merged) -> f32 {
  let variance = a.variance + b.variance;
  let covariance = a.covariance + b.covariance;
  let ofA = cofactorsOf(a.variance, a.covariance);
  let ofB = cofactorsOf(b.variance, b.covariance);
  let ofBoth = cofactorsOf(variance, covariance);
  var sumA = 0.0;
  var sumB = 0.0;
  for (var i = 0u; i < 6u; i++) {
    sumA += footprint(ofA, DIRECTIONS[i]);
    sumB += footprint(ofB, DIRECTIONS[i]);
  }
  // Areas along one direction are the mean ones times this, without a division by 0.
  let perA = 6.0 * a.weight / max(sumA, LEAST_AREA);
  let perB = 6.0 * b.weight / max(sumB, LEAST_AREA);
  let apart = a.center - b.center;
  var overlap = 0.0;
  for (var i = 0u; i < 6u; i++) {
    let n = DIRECTIONS[i];
    let areaA = perA * footprint(ofA, n);
    let areaB = perB * footprint(ofB, n);
    // Squares of smaller ones leave float32's range.
    let both = max(footprint(ofBoth, n), 1e-18);
    let m = cross(n, apart) / both;
    let distance2 = dot(variance, m * m) + 2.0 * dot(covariance, m.yzx * m.zxy);
    overlap += min(areaA * (areaB / both) * exp(-0.5 * max(distance2, 0.0)), min(areaA, areaB));
  }
  return overlap / 6.0;
}

/// The Gaussian with the same mean and covariance as both together, covering what both cover.
fn merge(a: Merged, b: Merged) -> Merged {
  let weight = a.weight + b.weight;
  let share = a.weight / weight;
  let rest = 1.0 - share;
  let apart = a.center - b.center;
  let moved = share * rest;
  return Merged(
    // Coordinates that both share stay as they are, however far out.
    a.center - rest * apart,
    weight - overlapOf(a, b),
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
