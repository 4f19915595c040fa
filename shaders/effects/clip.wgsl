// Leaves of a cloud what is on the kept side of up to eight volumes. Before anything is made of a splat: what is cut off
// costs no more than this.
import package::lib::edge_fade::edgeFade;
import package::lib::packing::Splat;
import parameters::Clip;

const CLIP_PLANE = 0.0;
const CLIP_SPHERE = 1.0;

fn clipSplat(splat: Splat, splatIndex: u32, parameters: Clip) -> Splat {
  let point = vec4f(splat.position, 1.0);
  let count = parameters.volumeCount;
  // The list is a value: with an index that is not constant, every thread would have to keep a copy of it in memory.
  let v = parameters.volumes;
  var clearance = clipClearance(point, v[0], v[1], v[2], v[3]);
  if (count > 1u) { clearance = min(clearance, clipClearance(point, v[4], v[5], v[6], v[7])); }
  if (count > 2u) { clearance = min(clearance, clipClearance(point, v[8], v[9], v[10], v[11])); }
  if (count > 3u) { clearance = min(clearance, clipClearance(point, v[12], v[13], v[14], v[15])); }
  if (count > 4u) { clearance = min(clearance, clipClearance(point, v[16], v[17], v[18], v[19])); }
  if (count > 5u) { clearance = min(clearance, clipClearance(point, v[20], v[21], v[22], v[23])); }
  if (count > 6u) { clearance = min(clearance, clipClearance(point, v[24], v[25], v[26], v[27])); }
  if (count > 7u) { clearance = min(clearance, clipClearance(point, v[28], v[29], v[30], v[31])); }
  var clipped = splat;
  clipped.opacity *= edgeFade(clearance, parameters.softEdge);
  return clipped;
}

/// How far a point of the cloud is from a volume's surface, world units, positive on the side that is kept. `x`, `y` and
/// `z` take it to the volume's own axes, about its middle; of a plane there is only `x`, its distance. `shape`: a box's
/// half size or, first, a sphere's radius; then the kind, negative where the outside is kept.
fn clipClearance(point: vec4f, x: vec4f, y: vec4f, z: vec4f, shape: vec4f) -> f32 {
  // The kind is the same for all splats: no thread waits for another here.
  if (shape.w == CLIP_PLANE) { return dot(x, point); }
  let offset = vec3f(dot(x, point), dot(y, point), dot(z, point));
  if (abs(shape.w) == CLIP_SPHERE) { return sign(shape.w) * (shape.x - length(offset)); }
  let beyond = abs(offset) - shape.xyz;
  let outside = length(max(beyond, vec3f(0.0)));
  let inside = max(beyond.x, max(beyond.y, beyond.z));
  return -sign(shape.w) * (outside + min(inside, 0.0));
}
