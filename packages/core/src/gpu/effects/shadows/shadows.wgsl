// Effect `shadows`: darkens a splat by the light that others keep from it. Runs per visible splat in
// project. Reads the colour, the splat, the depths from each light and the list of lights; returns the
// colour. Reference: shadows.reference.ts. falloff.wgsl is joined to it.
//
// The list begins with the light that throws no shadows, red, green and blue, and the number of
// lights. Seven vec4f follow for each light:
//
//   0…2   rows that map a point x, y, z, 1 to x and y of the light's clip space, and to its depth
//         in front of the light, world units
//   3     irradiance, red, green and blue, of a spot light at a distance of 1; strength of its shadow
//   4     offset and factor of stored depths; form of stored depths, below 0 if the nearest is
//         greatest; bias
//   5     world units that the splat is moved towards the light; decay and cutoff of a spot light
//   6     half extents of the image at depth 1; cosines of the cone and of its bright middle, the first
//         below −1 if the light is no spot light
import package::lib::covariance::rotationMatrix;
import package::lib::packing::Splat;
import package::lib::srgb::decodeSrgb;
import package::lib::srgb::encodeSrgb;
import parameters::shadowsAt;
import parameters::{shadowsMap0, shadowsMap1, shadowsMap2, shadowsMap3};

const LIGHT_VECTORS = 7u;
const MOST_LIGHTS = 4u;
/// Splats of one surface lie about this far, in standard deviations, in front of and behind each other.
const REACH = 3.0;
const FORM_LINEAR = 1.0;
const FORM_LOGARITHMIC = 3.0;

fn shadowsColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f) -> vec3f {
  let steady = shadowsAt(0u);
  let axes = rotationMatrix(splat.rotation);
  var all = steady.xyz;
  var kept = vec3f(0.0);
  for (var light = 0u; light < MOST_LIGHTS; light++) {
    if (light >= u32(steady.w)) { break; }
    let first = 1u + LIGHT_VECTORS * light;
    let point = vec4f(splat.position, 1.0);
    let depthRow = shadowsAt(first + 2u);
    let depth = dot(point, depthRow);
    let stored = shadowsAt(first + 4u);
    let scale = select(depth, 1.0, abs(stored.z) == FORM_LINEAR);
    let ndc = vec2f(dot(point, shadowsAt(first)), dot(point, shadowsAt(first + 1u))) / scale;
    let irradiance = shadowsAt(first + 3u);
    let received = irradiance.xyz * falloff(ndc, depth, first);
    all += received;
    if (any(received > vec3f(0.0))) {
      let spread = length((depthRow.xyz * axes) * splat.scale);
      let nearer = depth - REACH * spread - shadowsAt(first + 5u).x;
      kept += received * irradiance.w * (1.0 - lightThrough(light, ndc, nearer, stored));
    }
  }
  let share = 1.0 - kept / max(all, vec3f(1e-30));
  return encodeSrgb(decodeSrgb(color) * share);
}

/// Part of a light's irradiance that is left at a place and depth.
fn falloff(ndc: vec2f, depth: f32, first: u32) -> f32 {
  let cone = shadowsAt(first + 6u);
  if (cone.z < -1.0) { return 1.0; }
  if (!(depth > 0.0)) { return 0.0; }
  let aside = ndc * cone.xy;
  let oblique = sqrt(1.0 + dot(aside, aside));
  let decay = shadowsAt(first + 5u);
  return smoothstep(cone.z, cone.w, 1.0 / oblique) * lightLeft(depth * oblique, decay.y, decay.z);
}

/// Share of a light that reaches a point of its image at a view depth; 1 beyond the image.
fn lightThrough(light: u32, ndc: vec2f, depthView: f32, stored: vec4f) -> f32 {
  let form = abs(stored.z);
  if (any(abs(ndc) > vec2f(1.0)) || (form != FORM_LINEAR && !(depthView > 0.0))) { return 1.0; }
  var mapped = 1.0 / depthView;
  if (form == FORM_LINEAR) { mapped = depthView; }
  if (form == FORM_LOGARITHMIC) { mapped = log2(depthView); }
  let depth = stored.x + stored.y * mapped;
  let away = sign(stored.z);
  let tested = away * depth + stored.w;
  switch light {
    case 0u: { return litTexels(shadowsMap0, ndc, tested, away); }
    case 1u: { return litTexels(shadowsMap1, ndc, tested, away); }
    case 2u: { return litTexels(shadowsMap2, ndc, tested, away); }
    default: { return litTexels(shadowsMap3, ndc, tested, away); }
  }
}

/// Share of a square of three by three texels about a place whose depths are not in front of `tested`.
fn litTexels(map: texture_depth_2d, ndc: vec2f, tested: f32, away: f32) -> f32 {
  let size = textureDimensions(map);
  let place = (vec2f(0.5, -0.5) * ndc + 0.5) * vec2f(size) - 0.5;
  let corner = floor(place);
  let part = place - corner;
  let last = vec2i(size) - 1;
  var lit = 0.0;
  for (var y = 0; y < 4; y++) {
    for (var x = 0; x < 4; x++) {
      let texel = clamp(vec2i(corner) + vec2i(x, y) - 1, vec2i(0), last);
      let weight = texelWeight(x, part.x) * texelWeight(y, part.y);
      lit += select(0.0, weight, tested <= away * textureLoad(map, texel, 0));
    }
  }
  return lit / 9.0;
}

/// Overlap of texel `i` of four with a line of three texels that begins `part` behind its start.
fn texelWeight(i: i32, part: f32) -> f32 {
  if (i == 0) { return 1.0 - part; }
  return select(1.0, part, i == 3);
}
