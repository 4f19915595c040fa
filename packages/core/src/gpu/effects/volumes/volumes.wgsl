// Effect `volumes`: hides, fades, tints and displaces the splats in volumes, one volume after
// another. Runs per splat in cull-splats and project. Reads a splat and the list of volumes; returns
// the splat, or its colour.
//
// The list begins with counts: of volumes that change opacities and places, of all volumes, and of
// cells along each axis of the grid. Seven vec4f follow for each volume, tinting ones last, in the
// cloud's space about its origin:
//
//   0     middle and squared radius of a sphere outside of which the volume does nothing; −1: it
//         acts everywhere
//   1…3   rows that map a point x, y, z, 1 to its distances along the volume's axes, world units
//   4     half sizes along these axes, world units; kind
//   5     width of the soft edge; −1 if the outside is meant, else 1; half length of a capsule's
//         middle part
//   6     factors of the colour; or the displacement; or the factor of the opacity; w: what it does
//
// With cells, a grid follows: the first corner and the cells per unit, then the volumes that may act
// outside of it, and those of each cell, a bit for each volume, 24 to a number. Thus a splat meets the
// few volumes of its cell instead of all.
import package::lib::edge_fade::edgeFade;
import package::lib::packing::Splat;
import parameters::volumesAt;

const VOLUME_VECTORS = 7u;
const WORD_BITS = 24u;
const VECTOR_BITS = 96u;
const ALL_BITS = 16777215.0;
const VOLUME_PLANE = 0.0;
const VOLUME_BOX = 1.0;
const VOLUME_DISPLACES = 1.0;

fn changeByVolumes(splat: Splat, splatIndex: u32) -> Splat {
  var changed = splat;
  let end = u32(volumesAt(0u).x);
  // Cells allow for the displacements that are to come.
  let cell = cellAt(splat.position);
  for (var first = 0u; first < end; first += VECTOR_BITS) {
    let named = volumesIn(cell, first);
    // Most cells have none.
    if (all(named == vec4f(0.0))) { continue; }
    for (var before = first; before < min(end, first + VECTOR_BITS); before += WORD_BITS) {
      var acting = u32(named[(before - first) / WORD_BITS]) & bitsBelow(end - before);
      while (acting != 0u) {
        let at = 1u + VOLUME_VECTORS * (before + firstTrailingBit(acting));
        acting &= acting - 1u;
        let weight = volumeWeight(changed.position, at);
        if (weight == 0.0) { continue; }
        let change = volumesAt(at + 6u);
        if (change.w == VOLUME_DISPLACES) {
          changed.position += weight * change.xyz;
        } else {
          changed.opacity *= mix(1.0, change.x, weight);
        }
      }
    }
  }
  return changed;
}

fn tintByVolumes(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f) -> vec3f {
  var tinted = color;
  let counts = vec2u(volumesAt(0u).xy);
  let cell = cellAt(splat.position);
  for (var first = 0u; first < counts.y; first += VECTOR_BITS) {
    let named = volumesIn(cell, first);
    if (all(named == vec4f(0.0))) { continue; }
    for (var before = first; before < min(counts.y, first + VECTOR_BITS); before += WORD_BITS) {
      let others = bitsBelow(max(counts.x, before) - before);
      var acting = u32(named[(before - first) / WORD_BITS]) & bitsBelow(counts.y - before) & ~others;
      while (acting != 0u) {
        let at = 1u + VOLUME_VECTORS * (before + firstTrailingBit(acting));
        acting &= acting - 1u;
        let weight = volumeWeight(splat.position, at);
        if (weight == 0.0) { continue; }
        tinted *= mix(vec3f(1.0), volumesAt(at + 6u).xyz, weight);
      }
    }
  }
  return tinted;
}

/// The lowest `count` bits of a word, at most WORD_BITS.
fn bitsBelow(count: u32) -> u32 {
  return (1u << min(count, WORD_BITS)) - 1u;
}

/// Where a point's cell lies in the list; 0 without a grid.
fn cellAt(point: vec3f) -> u32 {
  let counts = volumesAt(0u);
  if (counts.z == 0.0) { return 0u; }
  let grid = 1u + VOLUME_VECTORS * u32(counts.y);
  let place = (point - volumesAt(grid).xyz) * volumesAt(grid + 1u).xyz;
  let isInside = all(place >= vec3f(0.0)) && all(place <= vec3f(counts.z));
  let cell = vec3u(clamp(place, vec3f(0.0), vec3f(counts.z - 1.0)));
  let index = select(0u, 1u + cell.x + u32(counts.z) * (cell.y + u32(counts.z) * cell.z), isInside);
  return grid + 2u + index * ((u32(counts.y) + VECTOR_BITS - 1u) / VECTOR_BITS);
}

/// Which of VECTOR_BITS volumes from number `first` on may act in a cell, a bit each: all without a
/// grid.
fn volumesIn(cell: u32, first: u32) -> vec4f {
  if (cell == 0u) { return vec4f(ALL_BITS); }
  return volumesAt(cell + first / VECTOR_BITS);
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
