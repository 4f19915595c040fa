// Decides which splats and blobs of the visible chunks the cut goes through: see
// lib/level-link.wgsl. Reads the page's plan, its visible chunks, links and the thresholds of
// cells; writes a bit per splat, for cull-splats. One thread per 32 splats of the visible chunks, and
// at most one workgroup per visible chunk, dispatched per page; with INSTANCES, per batch of
// instances of one page.
import constants::CHUNK_SPLATS;
import constants::MASK_WORDS;
import layout::ChunkLinks;
@if(!INSTANCES) import layout::Page;
import layout::PagePlan;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
@if(INSTANCES) import package::lib::instances::{enterInstance, page, pages};
import package::lib::level_link::isDrawnAt;

@group(0) @binding(0) var<uniform> view: View;
@if(!INSTANCES) @group(0) @binding(1) var<uniform> page: Page;
@group(0) @binding(2) var<storage, read> pagePlans: array<PagePlan>;
@group(0) @binding(3) var<storage, read> visibleChunks: array<u32>;
@group(0) @binding(4) var<storage, read> links: array<ChunkLinks>;
@group(0) @binding(5) var<storage, read> thresholds: array<u32>;
@group(0) @binding(6) var<storage, read_write> visibilityMasks: array<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn cutSplats(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  @if(INSTANCES) page.index = pages[0].index;
  let plan = pagePlans[page.index];
  let word = linearWorkgroup(workgroup, view.dispatchRow) * CHUNK_SPLATS + lane;
  if (word >= plan.slotCount * MASK_WORDS) { return; }
  let slot = plan.slotStart + word / MASK_WORDS;
  let first = 32u * (word % MASK_WORDS);
  @if(INSTANCES) enterInstance(visibleChunks[slot]);
  let chunk = visibleChunks[slot] - page.chunkStart;
  let limit = thresholds[page.cellStart + links[chunk].cell];
  var mask = 0u;
  for (var i = 0u; i < 32u; i++) {
    mask |= u32(isDrawnAt(links[chunk].links[first + i], limit)) << i;
  }
  visibilityMasks[plan.slotStart * MASK_WORDS + word] = mask;
}
