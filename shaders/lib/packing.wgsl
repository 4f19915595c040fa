// Unpacks splats as data/packing/geometry.ts stores them, one by one. Reference:
// reference/packing.ts.

/// A splat's geometry and base colour, in the cloud's space.
struct Splat {
  position: vec3f,
  /// Peak opacity, 0…1.
  opacity: f32,
  /// Unit quaternion w, x, y, z.
  rotation: vec4f,
  /// Standard deviation along each local axis.
  scale: vec3f,
  /// Spherical-harmonics coefficients of degree 0.
  colorDc: vec3f,
}

/// vec4u per splat: 64 bytes of float32, or 32 packed bytes.
@if(GEOMETRY_F32) const GEOMETRY_VECTORS = 4u;
@if(!GEOMETRY_F32) const GEOMETRY_VECTORS = 2u;

@if(GEOMETRY_F32)
fn unpackSplat(v: array<vec4u, GEOMETRY_VECTORS>) -> Splat {
  return Splat(
    bitcast<vec3f>(v[0].xyz),
    bitcast<f32>(v[0].w),
    bitcast<vec4f>(v[1]),
    bitcast<vec3f>(v[2].xyz),
    bitcast<vec3f>(v[3].xyz),
  );
}

/// `logScales`: the smallest of the splat's chunk, and the step of its unorm16 log scales.
@if(!GEOMETRY_F32)
fn unpackSplat(v: array<vec4u, GEOMETRY_VECTORS>, logScales: vec2f) -> Splat {
  let redGreen = unpack2x16float(v[0].w);
  let blue = unpack2x16float(v[1].x).x;
  let opacity = f32(v[1].x >> 16u) / 65535.0;
  let logScale = logScales.x + logScales.y * vec3f(vec3u(v[1].y & 0xffffu, v[1].y >> 16u, v[1].z & 0xffffu));
  @if(!ISOTROPIC) let rotation = unpackRotation(v[1].z >> 16u, v[1].w);
  @if(ISOTROPIC) let rotation = vec4f(1.0, 0.0, 0.0, 0.0);
  return Splat(bitcast<vec3f>(v[0].xyz), opacity, rotation, exp(logScale), vec3f(redGreen, blue));
}

/// Smallest-three: the largest component is positive and omitted, others are 15-bit steps in ±√½.
fn unpackRotation(low: u32, high: u32) -> vec4f {
  let steps = vec3u(low & 0x7fffu, high & 0x7fffu, (high >> 16u) & 0x7fffu);
  let largest = (low >> 15u) | (((high >> 15u) & 1u) << 1u);
  let rest = (vec3f(steps) - 16383.0) * (0.7071067811865476 / 16383.0);
  let w = sqrt(max(0.0, 1.0 - dot(rest, rest)));
  let first = vec4f(w, rest);
  let second = vec4f(rest.x, w, rest.yz);
  let third = vec4f(rest.xy, w, rest.z);
  let fourth = vec4f(rest, w);
  return select(select(fourth, third, largest == 2u), select(second, first, largest == 0u), largest < 2u);
}
