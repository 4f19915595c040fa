// Effect `clip`: hides the splats outside the kept sides of up to eight volumes. Runs per splat in
// cull-splats and project. Reads a splat and the volumes; returns the splat with its opacity
// multiplied by the soft edge. Runs before all else, so that a splat that is cut off costs no more
// than this.
import package::lib::edge_fade::edgeFade;
import package::lib::packing::Splat;
import parameters::Clip;

const CLIP_PLANE = 0.0;
const CLIP_SPHERE = 1.0;

fn clipSplat(splat: Splat, splatIndex: u32, parameters: Clip) -> Splat {
  let point = vec4f(splat.position, 1.0);
  let count = parameters.volumeCount;
  // The volumes are not an array: every thread copies arrays passed by value, element by element.
  var clearance = clipClearance(point, parameters.volume0);
  if (count > 1u) { clearance = min(clearance, clipClearance(point, parameters.volume1)); }
  if (count > 2u) { clearance = min(clearance, clipClearance(point, parameters.volume2)); }
  if (count > 3u) { clearance = min(clearance, clipClearance(point, parameters.volume3)); }
  if (count > 4u) { clearance = min(clearance, clipClearance(point, parameters.volume4)); }
  if (count > 5u) { clearance = min(clearance, clipClearance(point, parameters.volume5)); }
  if (count > 6u) { clearance = min(clearance, clipClearance(point, parameters.volume6)); }
  if (count > 7u) { clearance = min(clearance, clipClearance(point, parameters.volume7)); }
  var clipped = splat;
  clipped.opacity *= edgeFade(clearance, parameters.softEdge);
  return clipped;
}

/// Distance of a point x, y, z, 1 of the cloud from a volume's surface, world units, positive on
/// the kept side. The first three columns of `volume` map the point to its distances along the
/// volume's axes from the volume's middle (a plane has one axis). The fourth is the shape: a box's
/// half size, or a sphere's radius in x; w is the kind, negative if the outside is kept.
fn clipClearance(point: vec4f, volume: mat4x4f) -> f32 {
  let shape = volume[3];
  // The kind is the same for all splats, so threads do not diverge here.
  if (shape.w == CLIP_PLANE) { return dot(point, volume[0]); }
  let offset = vec3f(dot(point, volume[0]), dot(point, volume[1]), dot(point, volume[2]));
  if (abs(shape.w) == CLIP_SPHERE) { return sign(shape.w) * (shape.x - length(offset)); }
  let beyond = abs(offset) - shape.xyz;
  let outside = length(max(beyond, vec3f(0.0)));
  let inside = max(beyond.x, max(beyond.y, beyond.z));
  return -sign(shape.w) * (outside + min(inside, 0.0));
}
