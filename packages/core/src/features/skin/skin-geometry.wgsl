// Moves a page of geometry with joints, by linear blend skinning: the matrix of a splat is the mean of
// up to four joints' matrices by its weights. Positions follow the matrix exactly; so do covariances,
// which its linear part turns, stretches and shears to other ellipsoids. Reads the geometry at rest,
// four joints and weights per splat, and the joints' matrices; writes a page stored alike. One thread
// per splat.
import constants::CHUNK_SPLATS;
import layout::Chunk;
import layout::SkinParameters;
import package::lib::covariance::rotationMatrix;
import package::lib::dispatch::linearWorkgroup;
@if(!GEOMETRY_F32) import package::lib::pack_splat::packSplat;
@if(GEOMETRY_F32) import package::lib::pack_splat::storeSplat;
import package::lib::packing::GEOMETRY_VECTORS;
import package::lib::packing::Splat;
import package::lib::packing::unpackSplat;

@group(0) @binding(0) var<uniform> parameters: SkinParameters;
@group(0) @binding(1) var<storage, read> rest: array<array<vec4u, GEOMETRY_VECTORS>>;
@group(0) @binding(2) var<storage, read_write> skinned: array<array<vec4u, GEOMETRY_VECTORS>>;
/// Four joints, one byte each, and their weights as unorm8.
@group(0) @binding(3) var<storage, read> influences: array<vec2u>;
/// Three rows of each joint's matrix, about the cloud's origin.
@group(0) @binding(4) var<storage, read> joints: array<array<vec4f, 3>>;
@if(!GEOMETRY_F32) @group(0) @binding(5) var<storage, read> restChunks: array<Chunk>;
@if(!GEOMETRY_F32) @group(0) @binding(6) var<storage, read> chunks: array<Chunk>;

/// Sweeps of Jacobi rotations, which converge quadratically.
const SWEEPS = 5u;
/// Cosine of the angle between two axes from which on they count as perpendicular.
const PERPENDICULAR = 1e-6;
/// Part of the longest axis below which the direction of an axis is rounding.
const SHORTEST = 1e-15;

struct Axes { lengths: vec3f, rotation: vec4f }

@compute @workgroup_size(CHUNK_SPLATS)
fn skinGeometry(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_SPLATS + lane;
  if (index >= parameters.splatCount) { return; }
  @if(GEOMETRY_F32) skinned[index] = storeSplat(skinSplat(unpackSplat(rest[index]), influences[index]));
  @if(!GEOMETRY_F32) let stored = &restChunks[index / CHUNK_SPLATS];
  @if(!GEOMETRY_F32) let chunk = &chunks[index / CHUNK_SPLATS];
  @if(!GEOMETRY_F32) let splat = unpackSplat(rest[index], vec2f((*stored).minLogScale, (*stored).logScaleStep));
  @if(!GEOMETRY_F32) let range = vec2f((*chunk).minLogScale, (*chunk).logScaleStep);
  @if(!GEOMETRY_F32) skinned[index] = packSplat(skinSplat(splat, influences[index]), range);
}

fn skinSplat(splat: Splat, influence: vec2u) -> Splat {
  let weights = unpack4x8unorm(influence.y);
  var x = vec4f(0.0);
  var y = vec4f(0.0);
  var z = vec4f(0.0);
  for (var k = 0u; k < 4u; k++) {
    let joint = (influence.x >> (8u * k)) & 0xffu;
    x += weights[k] * joints[joint][0];
    y += weights[k] * joints[joint][1];
    z += weights[k] * joints[joint][2];
  }
  let position = vec4f(splat.position, 1.0);
  let linear = transpose(mat3x3f(x.xyz, y.xyz, z.xyz));
  let turned = linear * rotationMatrix(splat.rotation);
  let axes = ellipsoidAxes(mat3x3f(turned[0] * splat.scale.x, turned[1] * splat.scale.y, turned[2] * splat.scale.z));
  var moved = splat;
  moved.position = vec3f(dot(x, position), dot(y, position), dot(z, position));
  // Packing takes logarithms.
  moved.scale = max(axes.lengths, vec3f(1e-37));
  moved.rotation = axes.rotation;
  return moved;
}

/// Axes of the ellipsoid that `columns` map the unit ball to: singular values, and left singular
/// vectors as a rotation. One-sided Jacobi rotations (Hestenes) keep the digits of short axes, and
/// leave perpendicular columns alone.
fn ellipsoidAxes(columns: mat3x3f) -> Axes {
  let largest = max(max3(abs(columns[0])), max(max3(abs(columns[1])), max3(abs(columns[2]))));
  if (!(largest > 1e-37)) { return Axes(vec3f(0.0), vec4f(1.0, 0.0, 0.0, 0.0)); }
  var a = columns[0] / largest;
  var b = columns[1] / largest;
  var c = columns[2] / largest;
  for (var sweep = 0u; sweep < SWEEPS; sweep++) {
    let ab = rotationBetween(a, b);
    let a1 = ab.x * a - ab.y * b;
    b = ab.y * a + ab.x * b;
    a = a1;
    let ac = rotationBetween(a, c);
    let a2 = ac.x * a - ac.y * c;
    c = ac.y * a + ac.x * c;
    a = a2;
    let bc = rotationBetween(b, c);
    let b1 = bc.x * b - bc.y * c;
    c = bc.y * b + bc.x * c;
    b = b1;
  }
  let lengths = vec3f(length(a), length(b), length(c));
  return Axes(lengths * largest, rotationOfAxes(a, b, c, lengths));
}

/// Cosine and sine that make both columns perpendicular.
fn rotationBetween(p: vec3f, q: vec3f) -> vec2f {
  let pp = dot(p, p);
  let qq = dot(q, q);
  let pq = dot(p, q);
  if (!(abs(pq) > PERPENDICULAR * sqrt(pp) * sqrt(qq))) { return vec2f(1.0, 0.0); }
  let zeta = (qq - pp) / (2.0 * pq);
  let t = select(1.0, -1.0, zeta < 0.0) / (abs(zeta) + sqrt(1.0 + zeta * zeta));
  let cosine = inverseSqrt(1.0 + t * t);
  return vec2f(cosine, t * cosine);
}

/// Unit quaternion w, x, y, z that turns x, y and z to the perpendicular axes. The shortest axis follows
/// from the others, right-handed: an axis may point either way.
fn rotationOfAxes(a: vec3f, b: vec3f, c: vec3f, lengths: vec3f) -> vec4f {
  if (lengths.z <= min(lengths.x, lengths.y)) {
    let axes = perpendicularAxes(a, b, lengths.x, lengths.y);
    return quaternionOfAxes(axes[0], axes[1], axes[2]);
  }
  if (lengths.x <= lengths.y) {
    let axes = perpendicularAxes(b, c, lengths.y, lengths.z);
    return quaternionOfAxes(axes[2], axes[0], axes[1]);
  }
  let axes = perpendicularAxes(c, a, lengths.z, lengths.x);
  return quaternionOfAxes(axes[1], axes[2], axes[0]);
}

/// Right-handed axes along `p` and `q`, the longer of which decides.
fn perpendicularAxes(p: vec3f, q: vec3f, lengthP: f32, lengthQ: f32) -> mat3x3f {
  let isP = lengthP >= lengthQ;
  let first = normalize(select(q, p, isP));
  let second = perpendicularTo(first, select(p, q, isP), select(lengthP, lengthQ, isP));
  let x = select(second, first, isP);
  let y = select(first, second, isP);
  return mat3x3f(x, y, cross(x, y));
}

/// Unit vector nearest to `other` that is perpendicular to `first`; any, if `other` is too short.
fn perpendicularTo(first: vec3f, other: vec3f, otherLength: f32) -> vec3f {
  let size = abs(first);
  let isX = size.x <= min(size.y, size.z);
  let least = select(select(vec3f(0.0, 0.0, 1.0), vec3f(0.0, 1.0, 0.0), size.y <= size.z), vec3f(1.0, 0.0, 0.0), isX);
  let near = select(least, other / otherLength, otherLength > SHORTEST);
  return normalize(near - first * dot(first, near));
}

/// Each of the four squares has the largest component of the quaternion once; the largest divides best.
fn quaternionOfAxes(a: vec3f, b: vec3f, c: vec3f) -> vec4f {
  let squares = vec4f(1.0 + a.x + b.y + c.z, 1.0 + a.x - b.y - c.z, 1.0 - a.x + b.y - c.z, 1.0 - a.x - b.y + c.z);
  let largest = max(max(squares.x, squares.y), max(squares.z, squares.w));
  let w = vec4f(squares.x, b.z - c.y, c.x - a.z, a.y - b.x);
  let x = vec4f(b.z - c.y, squares.y, a.y + b.x, c.x + a.z);
  let y = vec4f(c.x - a.z, a.y + b.x, squares.z, b.z + c.y);
  let z = vec4f(a.y - b.x, c.x + a.z, b.z + c.y, squares.w);
  return normalize(select(select(select(z, y, squares.z == largest), x, squares.y == largest), w, squares.x == largest));
}

fn max3(v: vec3f) -> f32 {
  return max(v.x, max(v.y, v.z));
}
