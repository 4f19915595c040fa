// Effect `motion`: moves, turns and fades the splats of a scene that changes with the time. Runs per
// splat in cull-splats and project, and per chunk in cull-chunks. Reads a splat or a chunk's bounds,
// the motion of the page's splats or the reach of its chunks, and the time; returns the changed splat
// or bounds. Layout: data/packing/pack-motion.ts.
import constants::MOTION_WORDS;
import constants::MOST_ELAPSED;
import constants::REACH_WORDS;
import constants::TIME_INTERVALS;
import package::lib::chunk_frustum::ChunkBounds;
import package::lib::packing::Splat;
import parameters::Motion;

/// MOTION_WORDS per splat.
@group(0) @binding(19) var<storage, read> motion: array<f32>;
/// REACH_WORDS per chunk and interval of time.
@group(0) @binding(20) var<storage, read> motionReaches: array<f32>;

fn moveSplat(splat: Splat, splatIndex: u32, parameters: Motion) -> Splat {
  let first = splatIndex * MOTION_WORDS;
  let away = parameters.time - motion[first];
  let durations = away * motion[first + 1u];
  var moved = splat;
  // Beyond 9 durations exp would be subnormal, which devices may take for 0 or not.
  moved.opacity *= select(0.0, exp(-min(durations * durations, 81.0)), abs(durations) < 9.0);
  let elapsed = clamp(away, -MOST_ELAPSED, MOST_ELAPSED);
  let velocity = motionVector(first + 2u);
  let acceleration = motionVector(first + 5u);
  let jerk = motionVector(first + 8u);
  moved.position += elapsed * (velocity + elapsed * (acceleration + elapsed * jerk));
  let spin = vec4f(
    unpack2x16float(bitcast<u32>(motion[first + 11u])),
    unpack2x16float(bitcast<u32>(motion[first + 12u])),
  );
  moved.rotation = turnedBy(splat.rotation, vec4f(1.0, 0.0, 0.0, 0.0) + elapsed * spin);
  return moved;
}

fn motionVector(at: u32) -> vec3f {
  return vec3f(motion[at], motion[at + 1u], motion[at + 2u]);
}

/// The unit quaternion of rotation · turn; `rotation` if the product has no direction.
fn turnedBy(rotation: vec4f, turn: vec4f) -> vec4f {
  let product = vec4f(
    rotation.x * turn.x - dot(rotation.yzw, turn.yzw),
    rotation.x * turn.yzw + turn.x * rotation.yzw + cross(rotation.yzw, turn.yzw),
  );
  let largest = max(max(abs(product.x), abs(product.y)), max(abs(product.z), abs(product.w)));
  if (!(largest > 1e-20)) { return rotation; }
  return normalize(product / largest);
}

/// Bounds whose least is above their greatest hold no splat that can be seen.
fn moveBounds(bounds: ChunkBounds, chunkIndex: u32, parameters: Motion) -> ChunkBounds {
  let first = (chunkIndex * TIME_INTERVALS + parameters.interval) * REACH_WORDS;
  let least = vec3f(motionReaches[first], motionReaches[first + 1u], motionReaches[first + 2u]);
  let greatest = vec3f(motionReaches[first + 3u], motionReaches[first + 4u], motionReaches[first + 5u]);
  if (least.x > greatest.x) { return ChunkBounds(vec3f(1.0), vec3f(-1.0)); }
  return ChunkBounds(bounds.minPosition + least, bounds.maxPosition + greatest);
}
