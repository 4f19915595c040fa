// Copies a buffer, to find out how fast the device can read and write. One thread per four words.
import constants::COPY_WORKGROUP;
import constants::COPY_ROW;

@group(0) @binding(0) var<storage, read> wordsIn: array<vec4u>;
@group(0) @binding(1) var<storage, read_write> wordsOut: array<vec4u>;

@compute @workgroup_size(COPY_WORKGROUP)
fn copyWords(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let place = (workgroup.y * COPY_ROW + workgroup.x) * COPY_WORKGROUP + lane;
  if (place < arrayLength(&wordsOut)) { wordsOut[place] = wordsIn[place]; }
}
