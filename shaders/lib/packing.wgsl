// Unpacks and packs splats as layout/geometry.ts stores them, per splat. cull-splats and project unpack; repack-geometry
// also packs. Twin: reference/packing.ts.

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

/// `logScales`: the cloud's smallest log scale, and the step of its unorm16 log scales; float32 splats do not use it.
@if(GEOMETRY_F32)
fn unpackSplat(v: array<vec4u, GEOMETRY_VECTORS>, logScales: vec2f) -> Splat {
  return Splat(
    bitcast<vec3f>(v[0].xyz),
    bitcast<f32>(v[0].w),
    bitcast<vec4f>(v[1]),
    bitcast<vec3f>(v[2].xyz),
    bitcast<vec3f>(v[3].xyz),
  );
}

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

/// Smallest-three: the component of largest magnitude is positive and omitted, the others are 15-bit steps in ±√½.
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

/// vec4u per packed splat.
const PACKED_VECTORS = 2u;

/// Packs `splat` into 32 bytes, as layout/geometry.ts does. Steps may differ by one from the host's, which rounds in float64.
/// The step of `logScales` (its y) is 0 if all scales are the same.
fn packSplat(splat: Splat, logScales: vec2f) -> array<vec4u, PACKED_VECTORS> {
  let dc = vec3u(halfBits(splat.colorDc.x), halfBits(splat.colorDc.y), halfBits(splat.colorDc.z));
  let opacity = u32(floor(splat.opacity * 65535.0 + 0.5));
  var scale = vec3u(0u);
  if (logScales.y > 0.0) {
    let steps = floor((log(splat.scale) - logScales.x) / logScales.y + 0.5);
    scale = vec3u(clamp(steps, vec3f(0.0), vec3f(65535.0)));
  }
  let rotation = packRotation(splat.rotation);
  return array<vec4u, PACKED_VECTORS>(
    vec4u(bitcast<vec3u>(splat.position), dc.x | (dc.y << 16u)),
    vec4u(dc.z | (opacity << 16u), scale.x | (scale.y << 16u), scale.z | (rotation.x << 16u), rotation.y),
  );
}

/// Packs a rotation for `unpackRotation`: low, high.
fn packRotation(rotation: vec4f) -> vec2u {
  let size = abs(rotation);
  let ofFirstTwo = select(0u, 1u, size.y > size.x);
  let ofLastTwo = select(2u, 3u, size.w > size.z);
  let largest = select(ofFirstTwo, ofLastTwo, max(size.z, size.w) > max(size.x, size.y));
  // A quaternion and its negative are the same rotation, so the omitted component is made positive.
  let facing = select(rotation, -rotation, rotation[largest] < 0.0);
  let rest = select(
    select(facing.xyz, facing.xyw, largest == 2u),
    select(facing.xzw, facing.yzw, largest == 0u),
    largest < 2u,
  );
  let steps = vec3u(floor(rest * (1.4142135623730951 * 16383.0) + 0.5) + 16383.0);
  return vec2u(steps.x | ((largest & 1u) << 15u), steps.y | ((largest >> 1u) << 15u) | (steps.z << 16u));
}

/// Bits of the binary16 nearest to `value`, ties to even; values beyond ±65504 become ±65504. Twin of layout/half.ts. Uses
/// integers because WGSL leaves it to the device how pack2x16float rounds, and what it makes of 65520.
fn halfBits(value: f32) -> u32 {
  let bits = bitcast<u32>(value);
  let sign = (bits >> 16u) & 0x8000u;
  let magnitude = min(bits & 0x7fffffffu, 0x477fe000u);
  if (magnitude >= 0x38800000u) {
    return sign | ((magnitude + 0xfffu + ((magnitude >> 13u) & 1u) - 0x38000000u) >> 13u);
  }
  // Below 2^-14 binary16 is subnormal: multiples of 2^-24.
  let mantissa = (magnitude & 0x7fffffu) | 0x800000u;
  let shift = min(126u - (magnitude >> 23u), 31u);
  return sign | ((mantissa + (1u << (shift - 1u)) - 1u + ((mantissa >> shift) & 1u)) >> shift);
}
