// Packs splats as data/packing/geometry.ts stores them, one by one.
@if(GEOMETRY_F32) import package::lib::packing::GEOMETRY_VECTORS;
import package::lib::packing::Splat;

/// vec4u per packed splat.
const PACKED_VECTORS = 2u;

/// Packs `splat` into 32 bytes, as data/packing/geometry.ts does. Steps may differ by one from the
/// host's, which rounds in float64. `logScales` is the range of the splat's chunk.
fn packSplat(splat: Splat, logScales: vec2f) -> array<vec4u, PACKED_VECTORS> {
  let dc = vec3u(halfBits(splat.colorDc.x), halfBits(splat.colorDc.y), halfBits(splat.colorDc.z));
  let opacity = u32(floor(splat.opacity * 65535.0 + 0.5));
  let scale = logScaleSteps(log(splat.scale), logScales, 1.0);
  let rotation = packRotation(splat.rotation);
  return array<vec4u, PACKED_VECTORS>(
    vec4u(bitcast<vec3u>(splat.position), dc.x | (dc.y << 16u)),
    vec4u(dc.z | (opacity << 16u), scale.x | (scale.y << 16u), scale.z | (rotation.x << 16u), rotation.y),
  );
}

/// Stores `splat` as float32.
@if(GEOMETRY_F32)
fn storeSplat(splat: Splat) -> array<vec4u, GEOMETRY_VECTORS> {
  return array<vec4u, GEOMETRY_VECTORS>(
    vec4u(bitcast<vec3u>(splat.position), bitcast<u32>(splat.opacity)),
    bitcast<vec4u>(splat.rotation),
    vec4u(bitcast<vec3u>(splat.scale), 0u),
    vec4u(bitcast<vec3u>(splat.colorDc), 0u),
  );
}

/// The smallest of a chunk's log scales and the step of their unorm16, 0 if all are the same;
/// reference in data/packing/log-scale.ts.
fn logScaleRange(smallest: f32, largest: f32) -> vec2f {
  let extent = largest - smallest;
  return vec2f(smallest, select(0.0, extent * (1.0 / 65535.0), extent > 8.271806125530277e-25));
}

/// Log scales in parts of a step of `range`: `parts` parts to each of the 65535 steps.
fn logScaleSteps(logScale: vec3f, range: vec2f, parts: f32) -> vec3u {
  if (range.y == 0.0) { return vec3u(0u); }
  let steps = floor((logScale - range.x) / range.y * parts + 0.5);
  return vec3u(clamp(steps, vec3f(0.0), vec3f(65535.0 * parts)));
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

/// Bits of the binary16 nearest to `value`, ties to even; values beyond ±65504 become ±65504.
/// Reference: data/layout/half.ts. Uses integers because WGSL leaves it to the device how
/// pack2x16float rounds, and whether 65520 becomes infinite.
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
