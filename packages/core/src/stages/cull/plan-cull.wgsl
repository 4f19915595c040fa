// Lists the visible chunks of the frame in storage order, and sizes the dispatches over them on the
// GPU, so that their number is never read back. Reads the visibility flags of cull-chunks, and
// replaces them by their prefix sums: n flags give n + 1 sums, the total last. Writes visibleChunks,
// each page's slots, the number of slots and the dispatches of cull-splats and compact-splats, and
// resets the range of depths. Places come from a scan instead of atomics, so that a frame is the same
// every time. One workgroup, because dispatches that wait for each other take longer: a chunk is one
// count for 256 splats. With NARROW one thread.
import constants::SCAN_ITEMS;
import constants::SCAN_WORKGROUP;
import layout::CullParameters;
import layout::PagePlan;
import package::lib::dispatch::dispatchSize;
import package::lib::scan_run::{SCAN_RUN, scanRun};

@group(0) @binding(0) var<uniform> cullParameters: CullParameters;
@group(0) @binding(1) var<storage, read_write> chunkOffsets: array<u32>;
@group(0) @binding(2) var<storage, read_write> pagePlans: array<PagePlan>;
@group(0) @binding(3) var<storage, read_write> slotCount: u32;
/// Three words per page for cull-splats, then three for compact-splats.
@group(0) @binding(4) var<storage, read_write> cullDispatches: array<u32>;
@group(0) @binding(5) var<storage, read_write> depthRange: array<u32, 2>;
@group(0) @binding(6) var<storage, read_write> visibleChunks: array<u32>;

@compute @workgroup_size(SCAN_WORKGROUP)
fn planCull(@builtin(local_invocation_index) lane: u32) {
  let chunkCount = cullParameters.chunkCount;
  var slots = 0u;
  var next = flagsFrom(lane);
  for (var start = 0u; start < chunkCount; start += SCAN_RUN) {
    let flags = next;
    // Read before this run is scanned, so that no run waits for its flags.
    next = flagsFrom(start + SCAN_RUN + lane);
    let sums = scanRun(lane, SCAN_WORKGROUP, flags);
    @unroll for (var item = 0u; item < SCAN_ITEMS; item++) {
      let chunk = start + item * SCAN_WORKGROUP + lane;
      let slot = slots + sums.before[item];
      if (chunk < chunkCount) { chunkOffsets[chunk] = slot; }
      if (flags[item] == 1u) { visibleChunks[slot] = chunk; }
    }
    slots += sums.total;
  }
  if (lane == 0u) {
    chunkOffsets[chunkCount] = slots;
    slotCount = slots;
    writeDispatch(cullParameters.pageCount, slots);
    depthRange = array<u32, 2>(0u, 0u);
  }
  storageBarrier();
  for (var page = lane; page < cullParameters.pageCount; page += SCAN_WORKGROUP) {
    let start = chunkOffsets[pagePlans[page].chunkStart];
    let end = chunkOffsets[pagePlans[page].chunkEnd];
    pagePlans[page].slotStart = start;
    pagePlans[page].slotCount = end - start;
    writeDispatch(page, end - start);
  }
}

/// Flags of chunks that lie SCAN_WORKGROUP apart, from `first` on; 0 behind the last chunk.
fn flagsFrom(first: u32) -> array<u32, SCAN_ITEMS> {
  var flags: array<u32, SCAN_ITEMS>;
  @unroll for (var item = 0u; item < SCAN_ITEMS; item++) {
    let chunk = first + item * SCAN_WORKGROUP;
    if (chunk < cullParameters.chunkCount) { flags[item] = chunkOffsets[chunk]; }
  }
  return flags;
}

fn writeDispatch(index: u32, workgroups: u32) {
  let size = dispatchSize(workgroups, cullParameters.dispatchRow);
  cullDispatches[3u * index] = size.x;
  cullDispatches[3u * index + 1u] = size.y;
  cullDispatches[3u * index + 2u] = size.z;
}
