// Counts the bins that each visible splat may touch: the pairs that tile-emit will write for it.
// Reads the records in drawing order; writes, per rank, the number of pairs before it within its
// block of TILE_COUNT_BLOCK ranks, and the number of pairs of each block. One workgroup per block,
// TILE_COUNT_ITEMS ranks per thread. With RECOUNT: only if the plan has larger bins, whose pairs are
// counted then.
import constants::TILE_COUNT_BLOCK;
import constants::TILE_COUNT_ITEMS;
import constants::TILE_WORKGROUP;
import layout::SplatRecord;
import layout::TileGrid;
@if(RECOUNT) import layout::TilePlan;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
import package::lib::splat_ellipse::splatEllipse;
import package::lib::splat_record::{axesOf, opacityOf};
import package::lib::tile_grid::{binColumns, binRows};
@if(RECOUNT) import package::lib::tile_grid::wholeShift;
import package::lib::workgroup_scan::scanLanes;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> grid: TileGrid;
@group(0) @binding(2) var<storage, read> visibleCount: u32;
@group(0) @binding(3) var<storage, read> order: array<u32>;
@group(0) @binding(4) var<storage, read> records: array<SplatRecord>;
@group(0) @binding(5) var<storage, read_write> pairOffsets: array<u32>;
@group(0) @binding(6) var<storage, read_write> blockPairs: array<u32>;
@if(RECOUNT) @group(0) @binding(7) var<storage, read> tilePlan: TilePlan;

@compute @workgroup_size(TILE_WORKGROUP)
fn tileCount(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  @if(!RECOUNT) let shift = 0u;
  @if(RECOUNT) let shift = tilePlan.binShift;
  @if(RECOUNT) if (shift == 0u || shift >= wholeShift(grid)) { return; }
  let block = linearWorkgroup(workgroup, view.dispatchRow);
  if (block * TILE_COUNT_BLOCK >= visibleCount) { return; }
  let first = block * TILE_COUNT_BLOCK + lane * TILE_COUNT_ITEMS;
  var counts: array<u32, TILE_COUNT_ITEMS>;
  var sum = 0u;
  for (var item = 0u; item < TILE_COUNT_ITEMS; item++) {
    counts[item] = 0u;
    let rank = first + item;
    if (rank < visibleCount) { counts[item] = pairsOf(records[order[visibleCount - 1u - rank]], shift); }
    sum += counts[item];
  }
  var running = scanLanes(lane, sum) - sum;
  for (var item = 0u; item < TILE_COUNT_ITEMS; item++) {
    if (first + item < visibleCount) { pairOffsets[first + item] = running; }
    running += counts[item];
  }
  if (lane == TILE_WORKGROUP - 1u) { blockPairs[block] = running; }
}

fn pairsOf(splat: SplatRecord, shift: u32) -> u32 {
  let opacity = opacityOf(splat);
  if (opacity < view.alphaCutoff) { return 0u; }
  let ellipse = splatEllipse(splat.centerPx, axesOf(splat), opacity, view.alphaCutoff);
  let rows = binRows(ellipse, grid, shift);
  var count = 0u;
  let beyondRows = rows.y + 1;
  for (var row = rows.x; row < beyondRows; row++) {
    let columns = binColumns(ellipse, row, grid, shift);
    count += u32(max(0, columns.y - columns.x + 1));
  }
  return count;
}
