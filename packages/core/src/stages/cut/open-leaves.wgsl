// Tells the leaves of cells above the chunks whether the cells below them are on the GPU. If they
// are, a leaf is drawn from the error of its cell on, where that cell ends; if not, it stands for
// the missing cells at any threshold. Changes links. One workgroup per cell, one thread per leaf.
import constants::CELL_ROOTS;
import constants::CHUNK_SPLATS;
import layout::ChunkLinks;
import layout::OpenedLeaves;
import package::lib::dispatch::linearWorkgroup;
import package::lib::level_link::{linkOf, parentErrorOf, parentSlotOf};

@group(0) @binding(0) var<uniform> parameters: OpenedLeaves;
@group(0) @binding(1) var<storage, read_write> upperLinks: array<ChunkLinks>;

/// Leaves that are drawn at all thresholds up to their parent's error.
var<workgroup> closed: atomic<u32>;
/// Complement of the least own error.
var<workgroup> leastError: atomic<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn openLeaves(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let opened = linearWorkgroup(workgroup, parameters.dispatchRow);
  if (opened >= parameters.count) { return; }
  let chunk = parameters.chunks[opened / 4u][opened % 4u];
  let link = upperLinks[chunk].links[lane];
  if (link != 0u) {
    let below = lane / CELL_ROOTS;
    let error = parameters.errors[4u * opened + below / 4u][below % 4u];
    upperLinks[chunk].links[lane] = linkOf(error, parentErrorOf(link), parentSlotOf(link));
    atomicMax(&leastError, ~error);
    if (error == 0u) { atomicAdd(&closed, 1u); }
  }
  workgroupBarrier();
  if (lane == 0u) {
    upperLinks[chunk].leastError = ~atomicLoad(&leastError);
    // Where all are closed, budgets count all of the chunk at once.
    upperLinks[chunk].uncounted = select(0u, CHUNK_SPLATS - atomicLoad(&closed), atomicLoad(&closed) > 0u);
  }
}
