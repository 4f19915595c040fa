// Lists the visible chunks of the frame in storage order. Reads the scanned visibility flags of
// cull-chunks; writes visibleChunks. One thread per chunk of the frame. Places come from a scan
// instead of atomics, so that a frame is the same every time.
import constants::CHUNK_WORKGROUP;
import layout::CullParameters;
import package::lib::dispatch::linearWorkgroup;

@group(0) @binding(0) var<uniform> cullParameters: CullParameters;
@group(0) @binding(1) var<storage, read> chunkOffsets: array<u32>;
@group(0) @binding(2) var<storage, read_write> visibleChunks: array<u32>;

@compute @workgroup_size(CHUNK_WORKGROUP)
fn compactChunks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let chunk = linearWorkgroup(workgroup, cullParameters.dispatchRow) * CHUNK_WORKGROUP + lane;
  if (chunk >= cullParameters.chunkCount) { return; }
  let slot = chunkOffsets[chunk];
  if (chunkOffsets[chunk + 1u] > slot) { visibleChunks[slot] = chunk; }
}
