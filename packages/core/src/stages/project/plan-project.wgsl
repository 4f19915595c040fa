// Sizes the dispatches and the draw over the visible splats, on the GPU, so that their number is
// never read back. Reads the scanned counts of cull-splats; writes each page's range of visible
// splats, the total, the dispatches of project and of tile-count, and the arguments of the draw. One
// workgroup, whose threads share the pages.
import constants::PLAN_WORKGROUP;
import constants::PROJECT_WORKGROUP;
import constants::TILE_COUNT_BLOCK;
import layout::CullParameters;
import layout::PagePlan;
import package::lib::dispatch::dispatchSize;

@group(0) @binding(0) var<uniform> cullParameters: CullParameters;
@group(0) @binding(1) var<storage, read> splatOffsets: array<u32>;
@group(0) @binding(2) var<storage, read> slotCount: u32;
@group(0) @binding(3) var<storage, read_write> pagePlans: array<PagePlan>;
@group(0) @binding(4) var<storage, read_write> visibleCount: u32;
/// The dispatch of project over each page, then the dispatch of tile-count: three words each.
@group(0) @binding(5) var<storage, read_write> projectDispatches: array<u32>;
/// Vertices, instances, first vertex, first instance.
@group(0) @binding(6) var<storage, read_write> drawArguments: array<u32, 4>;

@compute @workgroup_size(PLAN_WORKGROUP)
fn planProject(@builtin(local_invocation_index) lane: u32) {
  for (var page = lane; page < cullParameters.pageCount; page += PLAN_WORKGROUP) {
    let slotStart = pagePlans[page].slotStart;
    let start = min(splatOffsets[slotStart], cullParameters.visibleCapacity);
    let end = min(splatOffsets[slotStart + pagePlans[page].slotCount], cullParameters.visibleCapacity);
    pagePlans[page].visibleStart = start;
    pagePlans[page].visibleCount = end - start;
    setDispatch(page, (end - start + PROJECT_WORKGROUP - 1u) / PROJECT_WORKGROUP);
  }
  if (lane == 0u) {
    let visible = min(splatOffsets[slotCount], cullParameters.visibleCapacity);
    visibleCount = visible;
    drawArguments = array<u32, 4>(4u, visible, 0u, 0u);
    setDispatch(cullParameters.pageCount, (visible + TILE_COUNT_BLOCK - 1u) / TILE_COUNT_BLOCK);
  }
}

fn setDispatch(index: u32, workgroups: u32) {
  let size = dispatchSize(workgroups, cullParameters.dispatchRow);
  projectDispatches[3u * index] = size.x;
  projectDispatches[3u * index + 1u] = size.y;
  projectDispatches[3u * index + 2u] = size.z;
}
