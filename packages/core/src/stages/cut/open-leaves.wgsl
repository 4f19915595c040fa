// Tells the leaves of a cell above the chunks whether the cells below them are on the GPU. If they
// are, a leaf is drawn from the error of its cell on, where that cell ends; if not, it stands for
// the missing cells at any threshold. Changes links. One workgroup, one thread per leaf.
import constants::CELL_ROOTS;
import constants::CHUNK_SPLATS;
import layout::ChunkLinks;
import layout::OpenedLeaves;
import package::lib::level_link::{linkOf, parentErrorOf, parentSlotOf};

@group(0) @binding(0) var<uniform> parameters: OpenedLeaves;
@group(0) @binding(1) var<storage, read_write> upperLinks: array<ChunkLinks>;

/// Leaves that are drawn at all thresholds up to their parent's error.
var<workgroup> closed: atomic<u32>;
/// Complement of the least own error.
var<workgroup> leastError: atomic<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn openLeaves(@builtin(local_invocation_index) lane: u32) {
  let link = upperLinks[parameters.chunk].links[lane];
  if (link != 0u) {
    let cell = lane / CELL_ROOTS;
    let error = parameters.errors[cell / 4u][cell % 4u];
    upperLinks[parameters.chunk].links[lane] = linkOf(error, parentErrorOf(link), parentSlotOf(link));
    atomicMax(&leastError, ~error);
    if (error == 0u) { atomicAdd(&closed, 1u); }
  }
  workgroupBarrier();
  if (lane == 0u) {
    upperLinks[parameters.chunk].leastError = ~atomicLoad(&leastError);
    // Where all are closed, budgets count all of the chunk at once.
    upperLinks[parameters.chunk].uncounted = select(0u, CHUNK_SPLATS - atomicLoad(&closed), atomicLoad(&closed) > 0u);
  }
}
