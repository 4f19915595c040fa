// Packs a page of float32 geometry. Reads float32 geometry and the ranges of log scales; writes
// packed geometry. One thread per splat. Runs on the GPU, which already holds the float32 plane, so
// that nothing is read back.
import constants::CHUNK_SPLATS;
import layout::Chunk;
import layout::RepackParameters;
import package::lib::dispatch::linearWorkgroup;
import package::lib::packing::GEOMETRY_VECTORS;
import package::lib::pack_splat::PACKED_VECTORS;
import package::lib::pack_splat::packSplat;
import package::lib::packing::unpackSplat;

@group(0) @binding(0) var<uniform> parameters: RepackParameters;
@group(0) @binding(1) var<storage, read> finer: array<array<vec4u, GEOMETRY_VECTORS>>;
@group(0) @binding(2) var<storage, read_write> coarser: array<array<vec4u, PACKED_VECTORS>>;
@group(0) @binding(3) var<storage, read> chunks: array<Chunk>;

@compute @workgroup_size(CHUNK_SPLATS)
fn repackGeometry(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_SPLATS + lane;
  if (index >= parameters.splatCount) { return; }
  let chunk = &chunks[index / CHUNK_SPLATS];
  coarser[index] = packSplat(unpackSplat(finer[index]), vec2f((*chunk).minLogScale, (*chunk).logScaleStep));
}
