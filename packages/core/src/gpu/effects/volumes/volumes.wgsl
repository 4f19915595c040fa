// Effect `volumes`: hides, fades, tints and displaces the splats in volumes, one volume after
// another. Runs per splat in cull-splats and project. Reads a splat and the list of volumes; returns
// the splat, or its colour.
//
// The list begins with two counts: of volumes that change opacities and places, and of all volumes.
// Seven vec4f follow for each volume, tinting ones last, in the cloud's space about its origin:
//
//   0     middle and squared radius of a sphere outside of which the volume does nothing; −1: it
//         acts everywhere
//   1…3   rows that map a point x, y, z, 1 to its distances along the volume's axes, world units
//   4     half sizes along these axes, world units; kind
//   5     width of the soft edge; −1 if the outside is meant, else 1; half length of a capsule's
//         middle part
//   6     factors of the colour; or the displacement; or the factor of the opacity; w: what it does
import package::lib::edge_fade::edgeFade;
import package::lib::packing::Splat;
import parameters::volumesAt;

const VOLUME_VECTORS = 7u;
const VOLUME_PLANE = 0.0;
const VOLUME_BOX = 1.0;
const VOLUME_DISPLACES = 1.0;

fn changeByVolumes(splat: Splat, splatIndex: u32) -> Splat {
  var changed = splat;
  let end = 1u + VOLUME_VECTORS * u32(volumesAt(0u).x);
  for (var at = 1u; at < end; at += VOLUME_VECTORS) {
    let weight = volumeWeight(changed.position, at);
    if (weight == 0.0) { continue; }
    let change = volumesAt(at + 6u);
    // The kind of change is the same for all splats, so threads do not diverge here.
    if (change.w == VOLUME_DISPLACES) {
      changed.position += weight * change.xyz;
    } else {
      changed.opacity *= mix(1.0, change.x, weight);
    }
  }
  return changed;
}

fn tintByVolumes(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f) -> vec3f {
  var tinted = color;
  let counts = volumesAt(0u);
  let end = 1u + VOLUME_VECTORS * u32(counts.y);
  for (var at = 1u + VOLUME_VECTORS * u32(counts.x); at < end; at += VOLUME_VECTORS) {
    let weight = volumeWeight(splat.position, at);
    if (weight == 0.0) { continue; }
    tinted *= mix(vec3f(1.0), volumesAt(at + 6u).xyz, weight);
  }
  return tinted;
}

/// How much the volume at an index of the list acts on a point: 1 up to its surface, 0 beyond its
/// soft edge.
fn volumeWeight(point: vec3f, at: u32) -> f32 {
  // Most volumes are far away from most splats.
  let bounds = volumesAt(at);
  let away = point - bounds.xyz;
  if (bounds.w >= 0.0 && dot(away, away) > bounds.w) { return 0.0; }
  let edge = volumesAt(at + 5u);
  return 1.0 - edgeFade(edge.y * volumeDistance(vec4f(point, 1.0), at, edge.z), edge.x);
}

/// Distance of a point x, y, z, 1 from a volume's surface, world units, negative inside.
fn volumeDistance(point: vec4f, at: u32, halfHeight: f32) -> f32 {
  let along = dot(point, volumesAt(at + 1u));
  let shape = volumesAt(at + 4u);
  // The kind is the same for all splats.
  if (shape.w == VOLUME_PLANE) { return -along; }
  var offset = vec3f(along, dot(point, volumesAt(at + 2u)), dot(point, volumesAt(at + 3u)));
  if (shape.w == VOLUME_BOX) {
    let beyond = abs(offset) - shape.xyz;
    return length(max(beyond, vec3f(0.0))) + min(max(beyond.x, max(beyond.y, beyond.z)), 0.0);
  }
  // A capsule is a sphere that is drawn out along y; an ellipsoid is one that is scaled.
  offset.y -= clamp(offset.y, -halfHeight, halfHeight);
  let inRadii = offset / shape.xyz;
  let radii = length(inRadii);
  if (radii == 0.0) { return -min(shape.x, min(shape.y, shape.z)); }
  // To first order: the value of the unit sphere's equation over its slope.
  return (radii - 1.0) / length(inRadii / radii / shape.xyz);
}
