// Sizes the dispatches over the visible chunks, on the GPU, so that their number is never read
// back. Reads the scanned visibility flags of cull-chunks; writes each page's slots, the number of
// slots and the dispatches of cull-splats and compact-splats, and resets the range of depths. One
// workgroup, whose threads share the pages.
import constants::PLAN_WORKGROUP;
import layout::CullParameters;
import layout::PagePlan;
import package::lib::dispatch::dispatchSize;

@group(0) @binding(0) var<uniform> cullParameters: CullParameters;
@group(0) @binding(1) var<storage, read> chunkOffsets: array<u32>;
@group(0) @binding(2) var<storage, read_write> pagePlans: array<PagePlan>;
@group(0) @binding(3) var<storage, read_write> slotCount: u32;
/// Three words per page for cull-splats, then three for compact-splats.
@group(0) @binding(4) var<storage, read_write> cullDispatches: array<u32>;
@group(0) @binding(5) var<storage, read_write> depthRange: array<u32, 2>;

@compute @workgroup_size(PLAN_WORKGROUP)
fn planCull(@builtin(local_invocation_index) lane: u32) {
  for (var page = lane; page < cullParameters.pageCount; page += PLAN_WORKGROUP) {
    let start = chunkOffsets[pagePlans[page].chunkStart];
    let end = chunkOffsets[pagePlans[page].chunkEnd];
    pagePlans[page].slotStart = start;
    pagePlans[page].slotCount = end - start;
    writeDispatch(page, end - start);
  }
  if (lane == 0u) {
    let slots = chunkOffsets[cullParameters.chunkCount];
    slotCount = slots;
    writeDispatch(cullParameters.pageCount, slots);
    depthRange = array<u32, 2>(0u, 0u);
  }
}

fn writeDispatch(index: u32, workgroups: u32) {
  let size = dispatchSize(workgroups, cullParameters.dispatchRow);
  cullDispatches[3u * index] = size.x;
  cullDispatches[3u * index + 1u] = size.y;
  cullDispatches[3u * index + 2u] = size.z;
}
