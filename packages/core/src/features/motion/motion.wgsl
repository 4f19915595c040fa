// Effect `motion`: moves, turns and fades the splats of a scene that changes with the time. Runs per
// splat in cull-splats and project, and per chunk in cull-chunks. Reads a splat or a chunk's bounds,
// the motion of the page's splats or the reach of its chunks, and the time; returns the changed splat
// or bounds. Layout: features/motion/pack-motion.data.ts.
import constants::LEAST_ROTATION;
import constants::MOST_ELAPSED;
import constants::MOTION_WORDS;
import constants::REACH_WORDS;
import constants::TIME_INTERVALS;
import package::lib::chunk_frustum::ChunkBounds;
import package::lib::packing::Splat;
import parameters::Motion;

/// MOTION_WORDS / 4 per splat.
@group(0) @binding(19) var<storage, read> motion: array<vec4f>;
/// REACH_WORDS per chunk and interval of time.
@group(0) @binding(20) var<storage, read> motionReaches: array<f32>;

fn moveSplat(splat: Splat, splatIndex: u32, parameters: Motion) -> Splat {
  let first = splatIndex * (MOTION_WORDS / 4u);
  let velocity = motion[first];
  let acceleration = motion[first + 1u];
  let jerk = motion[first + 2u];
  let away = parameters.time - velocity.w;
  // Beyond 9 durations exp would be subnormal, which devices may take for 0 or not.
  let durations = min(abs(away * acceleration.w), 9.0);
  var moved = splat;
  moved.opacity *= select(0.0, exp(-durations * durations), durations < 9.0);
  let elapsed = clamp(away, -MOST_ELAPSED, MOST_ELAPSED);
  moved.position += elapsed * (velocity.xyz + elapsed * (acceleration.xyz + elapsed * jerk.xyz));
  moved.rotation = turnedBy(splat.rotation, vec4f(1.0, 0.0, 0.0, 0.0) + elapsed * motion[first + 3u]);
  return moved;
}

/// The unit quaternion of rotation · turn; the identity if the turn cancels the rotation, of length 1.
fn turnedBy(rotation: vec4f, turn: vec4f) -> vec4f {
  let largest = max(max(abs(turn.x), abs(turn.y)), max(abs(turn.z), abs(turn.w)));
  if (largest < LEAST_ROTATION) { return vec4f(1.0, 0.0, 0.0, 0.0); }
  // Divided first: a long turn has no length in float32.
  let part = turn / largest;
  return normalize(vec4f(
    rotation.x * part.x - dot(rotation.yzw, part.yzw),
    rotation.x * part.yzw + part.x * rotation.yzw + cross(rotation.yzw, part.yzw),
  ));
}

/// Bounds whose least is above their greatest hold no splat that can be seen.
fn moveBounds(bounds: ChunkBounds, chunkIndex: u32, parameters: Motion) -> ChunkBounds {
  let first = (chunkIndex * TIME_INTERVALS + parameters.interval) * REACH_WORDS;
  let least = vec3f(motionReaches[first], motionReaches[first + 1u], motionReaches[first + 2u]);
  let greatest = vec3f(motionReaches[first + 3u], motionReaches[first + 4u], motionReaches[first + 5u]);
  if (least.x > greatest.x) { return ChunkBounds(vec3f(1.0), vec3f(-1.0)); }
  return ChunkBounds(bounds.minPosition + least, bounds.maxPosition + greatest);
}
