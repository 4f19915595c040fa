// Lists the visible splats of the frame in storage order, as many as there is room for. Reads the
// visibility masks of cull-splats and the scanned counts; writes visibleSplats. One workgroup per
// visible chunk, one thread per splat. A splat's number counts through all chunks of the frame.
// Places come from a scan instead of atomics, so that a frame is the same every time.
import constants::CHUNK_SPLATS;
import constants::MASK_WORDS;
import layout::CullParameters;
import package::lib::dispatch::linearWorkgroup;

@group(0) @binding(0) var<uniform> cullParameters: CullParameters;
@group(0) @binding(1) var<storage, read> slotCount: u32;
@group(0) @binding(2) var<storage, read> visibleChunks: array<u32>;
@group(0) @binding(3) var<storage, read> visibilityMasks: array<u32>;
@group(0) @binding(4) var<storage, read> splatOffsets: array<u32>;
@group(0) @binding(5) var<storage, read_write> visibleSplats: array<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn compactSplats(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let slot = linearWorkgroup(workgroup, cullParameters.dispatchRow);
  if (slot >= slotCount) { return; }
  let masks = slot * MASK_WORDS;
  let word = lane / 32u;
  let bits = visibilityMasks[masks + word];
  let bit = 1u << (lane % 32u);
  if ((bits & bit) == 0u) { return; }
  var rank = countOneBits(bits & (bit - 1u));
  for (var before = 0u; before < word; before++) { rank += countOneBits(visibilityMasks[masks + before]); }
  let place = splatOffsets[slot] + rank;
  if (place < cullParameters.visibleCapacity) { visibleSplats[place] = visibleChunks[slot] * CHUNK_SPLATS + lane; }
}
