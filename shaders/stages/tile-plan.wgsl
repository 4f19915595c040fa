// Decides whether this frame's pairs fit, and sizes the tile stages by their number, on the GPU, so
// that it is never read back within the frame. Reads the number of pairs of each block of ranks;
// writes the pairs before each block, the plan of the tiles and of their sort, and the arguments of
// the quads: they draw nothing where the tiles draw everything. One workgroup.
import constants::SORT_BLOCK;
import constants::TILE_COUNT_BLOCK;
import constants::TILE_WORKGROUP;
import layout::SortPlan;
import layout::TileGrid;
import layout::TilePlan;
import package::lib::workgroup_scan::{MOST_PAIRS, scanLanes, sumOfLanes};

@group(0) @binding(0) var<uniform> grid: TileGrid;
@group(0) @binding(1) var<storage, read> visibleCount: u32;
@group(0) @binding(2) var<storage, read_write> blockPairs: array<u32>;
@group(0) @binding(3) var<storage, read_write> tilePlan: TilePlan;
@group(0) @binding(4) var<storage, read_write> sortPlan: SortPlan;
/// Vertices, instances, first vertex, first instance.
@group(0) @binding(5) var<storage, read_write> drawArguments: array<u32, 4>;

@compute @workgroup_size(TILE_WORKGROUP)
fn planTiles(@builtin(local_invocation_index) lane: u32) {
  let blocks = (visibleCount + TILE_COUNT_BLOCK - 1u) / TILE_COUNT_BLOCK;
  var total = 0u;
  for (var first = 0u; first < blocks; first += TILE_WORKGROUP) {
    let block = first + lane;
    var pairs = 0u;
    if (block < blocks) { pairs = min(blockPairs[block], MOST_PAIRS); }
    let sum = scanLanes(lane, pairs);
    if (block < blocks) { blockPairs[block] = min(total + sum - pairs, MOST_PAIRS); }
    total = min(total + sumOfLanes(), MOST_PAIRS);
  }
  if (lane == 0u) {
    let fits = total <= grid.pairCapacity;
    let pairs = select(0u, total, fits);
    tilePlan = TilePlan(total, pairs, u32(fits), visibleCount);
    sortPlan = SortPlan(pairs, (pairs + SORT_BLOCK - 1u) / SORT_BLOCK);
    drawArguments = array<u32, 4>(4u, select(visibleCount, 0u, fits), 0u, 0u);
  }
}
