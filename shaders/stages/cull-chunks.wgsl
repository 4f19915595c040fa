// Decides which chunks of splats can reach into the image. Reads the chunks' bounds; writes 1 or 0
// per chunk to chunkOffsets, which a scan then turns into places. One thread per chunk, dispatched
// per page.
import constants::CHUNK_WORKGROUP;
import layout::View;
import layout::Page;
import layout::Chunk;
import package::lib::dispatch::linearWorkgroup;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> page: Page;
@group(0) @binding(2) var<storage, read> chunks: array<Chunk>;
@group(0) @binding(3) var<storage, read_write> chunkOffsets: array<u32>;

/// Float32 rounding of the test against a side of the frustum, relative to its largest term; far
/// above 6e-8 times the few operations.
const ROUNDING_SLACK = 1e-5;

@compute @workgroup_size(CHUNK_WORKGROUP)
fn cullChunks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = linearWorkgroup(workgroup, view.dispatchRow) * CHUNK_WORKGROUP + lane;
  if (index >= page.chunkCount) { return; }
  chunkOffsets[page.chunkStart + index] = select(0u, 1u, isInFrustum(chunks[index]));
}

fn isInFrustum(chunk: Chunk) -> bool {
  let center = 0.5 * (chunk.minPosition + chunk.maxPosition);
  let halfExtent = 0.5 * (chunk.maxPosition - chunk.minPosition);
  // With room for rounding.
  let maxScale = 1.001 * exp(chunk.minLogScale + 65535.0 * chunk.logScaleStep);
  for (var i = 0u; i < 6u; i++) {
    let plane = page.frustum[i];
    // How far a splat at the box's best corner still reaches past this side of the frustum.
    let reach = dot(abs(plane.xyz), halfExtent) + page.frustumReach[i].x * maxScale;
    let slack = ROUNDING_SLACK * (dot(abs(plane.xyz), abs(center)) + reach + abs(plane.w));
    if (dot(plane.xyz, center) + plane.w + reach + slack < 0.0) { return false; }
  }
  return true;
}
