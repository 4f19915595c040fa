// Decides which splats and blobs of the visible chunks the cut goes through: see
// lib/level-link.wgsl. Reads the page's plan, its visible chunks, links and the thresholds of
// cells; writes a bit per splat, for cull-splats. One workgroup per visible chunk, one thread per
// splat, dispatched per page.
import constants::CHUNK_SPLATS;
import constants::MASK_WORDS;
import layout::ChunkLinks;
import layout::Page;
import layout::PagePlan;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
import package::lib::level_link::isDrawnAt;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> page: Page;
@group(0) @binding(2) var<storage, read> pagePlans: array<PagePlan>;
@group(0) @binding(3) var<storage, read> visibleChunks: array<u32>;
@group(0) @binding(4) var<storage, read> links: array<ChunkLinks>;
@group(0) @binding(5) var<storage, read> thresholds: array<u32>;
@group(0) @binding(6) var<storage, read_write> visibilityMasks: array<u32>;

var<workgroup> mask: array<atomic<u32>, MASK_WORDS>;

@compute @workgroup_size(CHUNK_SPLATS)
fn cutSplats(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let plan = pagePlans[page.index];
  let slotInPage = linearWorkgroup(workgroup, view.dispatchRow);
  if (slotInPage >= plan.slotCount) { return; }
  let slot = plan.slotStart + slotInPage;
  let chunk = visibleChunks[slot] - page.chunkStart;
  if (isDrawnAt(links[chunk].links[lane], thresholds[links[chunk].cell])) {
    atomicOr(&mask[lane / 32u], 1u << (lane % 32u));
  }
  workgroupBarrier();
  if (lane < MASK_WORDS) { visibilityMasks[slot * MASK_WORDS + lane] = atomicLoad(&mask[lane]); }
}
