const KIND_DIRECTIONAL = 0.0;
const KIND_HEMISPHERE = 2.0;
/// Mean of max(0, cos θ) over all directions.
const EVENLY_LIT = 0.25;
const PI = 3.14159265358979;

/// A splat as light meets it, in view space.
struct Surface {
  center: vec3f,
  /// Unit vector towards the eye's side, and how far it counts, 0…1.
  normal: vec4f,
}

/// The shortest axis and the splat's flatness, 1 − shortest / middle deviation.
fn shadingNormal(splat: Splat, centerView: vec3f, rows: array<vec4f, 3>) -> vec4f {
  let axes = rotationMatrix(splat.rotation);
  let scale = splat.scale;
  let shortest = min(scale.x, min(scale.y, scale.z));
  let middle = max(min(scale.x, scale.y), min(max(scale.x, scale.y), scale.z));
  let axis = select(select(axes[2], axes[1], scale.y == shortest), axes[0], scale.x == shortest);
  let turned = vec3f(dot(rows[0].xyz, axis), dot(rows[1].xyz, axis), dot(rows[2].xyz, axis));
  let size = length(turned);
  let toEye = select(-centerView, vec3f(0.0, 0.0, 1.0), rows[2].w == 1.0);
  let side = select(1.0, -1.0, dot(turned, toEye) < 0.0);
  // A cloud that its matrix makes a line has no normals.
  let flatness = select(0.0, 1.0 - shortest / middle, middle > 0.0 && size > 0.0);
  return vec4f(side * turned / max(size, 1e-37), flatness);
}

/// Irradiance that a surface gets from a light, by its four vec4f of the list.
fn received(surface: Surface, place: vec4f, direct: vec4f, shining: vec4f, cone: vec4f) -> vec3f {
  let normal = surface.normal.xyz;
  let flatness = surface.normal.w;
  if (place.w == KIND_HEMISPHERE) {
    return mix(shining.xyz, direct.xyz, 0.5 + 0.5 * flatness * dot(normal, place.xyz));
  }
  var toLight = place.xyz;
  var left = 1.0;
  if (place.w != KIND_DIRECTIONAL) {
    let way = place.xyz - surface.center;
    let distance = length(way);
    toLight = way / max(distance, 1e-20);
    left = smoothstep(cone.x, cone.y, -dot(shining.xyz, toLight)) * lightLeft(distance, direct.w, shining.w);
  }
  return direct.xyz * (left * mix(EVENLY_LIT, max(dot(normal, toLight), 0.0), flatness));
}

/// A colour under light that it was not captured in.
fn relit(color: vec3f, irradiance: vec3f, strength: f32) -> vec3f {
  return encodeSrgb(decodeSrgb(color) * mix(vec3f(1.0), irradiance / PI, strength));
}
