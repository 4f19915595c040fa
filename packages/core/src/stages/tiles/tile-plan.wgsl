// Decides how large bins are, so that this frame's pairs fit, and sizes the tile stages by their
// number, on the GPU, so that it is never read back within the frame. Larger bins have fewer pairs,
// take longer, and show the same picture. Reads the number of pairs of each block of ranks; writes
// the pairs before each block, the plan of the tiles and of their sort, the dispatches over blocks of
// the sort and over groups of masks, and the arguments of the quads: they draw nothing where the tiles
// draw everything. With RECOUNT: does so once more, if the
// pairs have been counted again. One workgroup.
import constants::MASK_GROUP;
import constants::SORT_BLOCK;
import constants::TILE_COUNT_BLOCK;
import constants::TILE_WORKGROUP;
import layout::SortPlan;
import layout::TileGrid;
import layout::TilePlan;
import layout::View;
import package::lib::dispatch::dispatchSize;
import package::lib::tile_grid::wholeShift;
import package::lib::workgroup_scan::{MOST_PAIRS, scanLanes, sumOfLanes};

@group(0) @binding(0) var<uniform> grid: TileGrid;
@group(0) @binding(1) var<storage, read> visibleCount: u32;
@group(0) @binding(2) var<storage, read_write> blockPairs: array<u32>;
@group(0) @binding(3) var<storage, read_write> tilePlan: TilePlan;
@group(0) @binding(4) var<storage, read_write> sortPlan: SortPlan;
/// Vertices, instances, first vertex, first instance.
@group(0) @binding(5) var<storage, read_write> drawArguments: array<u32, 4>;
@group(0) @binding(6) var<uniform> view: View;
/// Of blocks, then of groups.
@group(0) @binding(7) var<storage, read_write> pairDispatches: array<u32, 6>;

/// Blocks per thread and round: reading them one after the other would take longer than adding them up.
const RUN = 8u;
const ROUND = RUN * TILE_WORKGROUP;
/// Share of the room that estimated pairs may take: the estimate of larger bins may be too low.
const SPARE = 0.8;

@if(RECOUNT) var<workgroup> firstShift: u32;

@compute @workgroup_size(TILE_WORKGROUP)
fn planTiles(@builtin(local_invocation_index) lane: u32) {
  @if(RECOUNT) if (lane == 0u) { firstShift = tilePlan.binShift; }
  @if(RECOUNT) let counted = workgroupUniformLoad(&firstShift);
  @if(RECOUNT) if (counted == 0u || counted >= wholeShift(grid)) { return; }
  let blocks = (visibleCount + TILE_COUNT_BLOCK - 1u) / TILE_COUNT_BLOCK;
  var total = 0u;
  for (var first = 0u; first < blocks; first += ROUND) {
    var pairs: array<u32, RUN>;
    var ofRun = 0u;
    for (var i = 0u; i < RUN; i++) {
      let block = first + lane * RUN + i;
      if (block < blocks) { pairs[i] = min(blockPairs[block], MOST_PAIRS); }
      ofRun = min(ofRun + pairs[i], MOST_PAIRS);
    }
    var before = total + scanLanes(lane, ofRun) - ofRun;
    for (var i = 0u; i < RUN; i++) {
      let block = first + lane * RUN + i;
      if (block < blocks) { blockPairs[block] = min(before, MOST_PAIRS); }
      before = min(before + pairs[i], MOST_PAIRS);
    }
    total = min(total + sumOfLanes(), MOST_PAIRS);
  }
  if (lane == 0u) {
    let whole = wholeShift(grid);
    @if(!RECOUNT) let shift = select(shiftFor(total, whole), 0u, total <= grid.pairCapacity);
    @if(RECOUNT) let shift = select(whole, counted, total <= grid.pairCapacity);
    @if(!RECOUNT) let isKnown = shift == 0u || shift == whole;
    @if(RECOUNT) let isKnown = true;
    @if(!RECOUNT) let needed = total;
    @if(RECOUNT) let needed = tilePlan.neededPairs;
    let wanted = select(total, visibleCount, shift > 0u && shift == whole);
    let fits = isKnown && wanted <= grid.pairCapacity;
    let pairs = select(0u, wanted, fits);
    tilePlan = TilePlan(needed, pairs, u32(fits), visibleCount, shift);
    sortPlan = SortPlan(pairs, (pairs + SORT_BLOCK - 1u) / SORT_BLOCK);
    let sortBlocks = dispatchSize(sortPlan.blockCount, view.dispatchRow);
    let groups = dispatchSize((pairs + MASK_GROUP - 1u) / MASK_GROUP, view.dispatchRow);
    pairDispatches = array<u32, 6>(sortBlocks.x, sortBlocks.y, sortBlocks.z, groups.x, groups.y, groups.z);
    drawArguments = array<u32, 4>(4u, select(visibleCount, 0u, fits), 0u, 0u);
  }
}

/// Least shift at which the pairs are expected to fit. A splat over n bins keeps about n·4^−shift
/// pairs, one more, and 2·√n·2^−shift along its edge.
@if(!RECOUNT)
fn shiftFor(total: u32, whole: u32) -> u32 {
  let visible = f32(visibleCount);
  for (var shift = 1u; shift < whole; shift++) {
    let width = f32(1u << shift);
    let pairs = f32(total) / (width * width) + 2.0 * sqrt(visible * f32(total)) / width + visible;
    if (pairs <= SPARE * f32(grid.pairCapacity)) { return shift; }
  }
  return whole;
}
