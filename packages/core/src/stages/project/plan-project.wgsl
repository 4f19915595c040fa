// Sizes the dispatches and the draw over the visible splats, on the GPU, so that their number is
// never read back. Reads the counts of cull-splats, one for each visible chunk, and replaces them by
// their prefix sums: n counts give n + 1 sums, the total last. Writes each page's range of visible
// splats, the total, the dispatches of project and of tile-count, the plan and dispatch of the sort
// by depth, and the arguments of the draw. One workgroup, because dispatches that wait for each other
// take longer. With NARROW one thread.
import constants::PROJECT_WORKGROUP;
import constants::SCAN_ITEMS;
import constants::SCAN_WORKGROUP;
import constants::SORT_BLOCK;
import constants::TILE_COUNT_BLOCK;
import layout::CullParameters;
import layout::PagePlan;
import layout::SortPlan;
import package::lib::dispatch::dispatchSize;
import package::lib::scan_run::{SCAN_RUN, scanRun};

@group(0) @binding(0) var<uniform> cullParameters: CullParameters;
@group(0) @binding(1) var<storage, read_write> splatOffsets: array<u32>;
@group(0) @binding(2) var<storage, read> slotCount: u32;
@group(0) @binding(3) var<storage, read_write> pagePlans: array<PagePlan>;
@group(0) @binding(4) var<storage, read_write> visibleCount: u32;
/// The dispatch of project over each page, then the dispatch of tile-count: three words each.
@group(0) @binding(5) var<storage, read_write> projectDispatches: array<u32>;
/// Vertices, instances, first vertex, first instance.
@group(0) @binding(6) var<storage, read_write> drawArguments: array<u32, 4>;
@group(0) @binding(7) var<storage, read_write> depthSortPlan: SortPlan;
@group(0) @binding(8) var<storage, read_write> depthSortDispatch: array<u32, 3>;

@compute @workgroup_size(SCAN_WORKGROUP)
fn planProject(@builtin(local_invocation_index) lane: u32) {
  let capacity = cullParameters.visibleCapacity;
  var splats = 0u;
  var next = countsFrom(lane);
  for (var start = 0u; start < slotCount; start += SCAN_RUN) {
    let counts = next;
    // Read before this run is scanned, so that no run waits for its counts.
    next = countsFrom(start + SCAN_RUN + lane);
    let sums = scanRun(lane, SCAN_WORKGROUP, counts);
    @unroll for (var item = 0u; item < SCAN_ITEMS; item++) {
      let slot = start + item * SCAN_WORKGROUP + lane;
      if (slot < slotCount) { splatOffsets[slot] = splats + sums.before[item]; }
    }
    splats += sums.total;
  }
  if (lane == 0u) {
    splatOffsets[slotCount] = splats;
    let visible = min(splats, capacity);
    visibleCount = visible;
    drawArguments = array<u32, 4>(4u, visible, 0u, 0u);
    setDispatch(cullParameters.pageCount, (visible + TILE_COUNT_BLOCK - 1u) / TILE_COUNT_BLOCK);
    let blocks = (visible + SORT_BLOCK - 1u) / SORT_BLOCK;
    depthSortPlan = SortPlan(visible, blocks);
    let size = dispatchSize(blocks, cullParameters.dispatchRow);
    depthSortDispatch = array<u32, 3>(size.x, size.y, size.z);
  }
  storageBarrier();
  for (var page = lane; page < cullParameters.pageCount; page += SCAN_WORKGROUP) {
    let slotStart = pagePlans[page].slotStart;
    let start = min(splatOffsets[slotStart], capacity);
    let end = min(splatOffsets[slotStart + pagePlans[page].slotCount], capacity);
    pagePlans[page].visibleStart = start;
    pagePlans[page].visibleCount = end - start;
    setDispatch(page, (end - start + PROJECT_WORKGROUP - 1u) / PROJECT_WORKGROUP);
  }
}

/// Counts of slots that lie SCAN_WORKGROUP apart, from `first` on; 0 behind the last slot.
fn countsFrom(first: u32) -> array<u32, SCAN_ITEMS> {
  var counts: array<u32, SCAN_ITEMS>;
  @unroll for (var item = 0u; item < SCAN_ITEMS; item++) {
    let slot = first + item * SCAN_WORKGROUP;
    if (slot < slotCount) { counts[item] = splatOffsets[slot]; }
  }
  return counts;
}

fn setDispatch(index: u32, workgroups: u32) {
  let size = dispatchSize(workgroups, cullParameters.dispatchRow);
  projectDispatches[3u * index] = size.x;
  projectDispatches[3u * index + 1u] = size.y;
  projectDispatches[3u * index + 2u] = size.z;
}
