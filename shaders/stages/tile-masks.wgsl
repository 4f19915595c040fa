// Finds the tiles of its bin that each pair's splat may touch; the blocks of tiles, where bins are
// larger. Reads the sorted pairs and the records; writes a bit per pair and tile, or block. One
// workgroup per group of 256 pairs, one thread per pair; a group's words lie together by tile, so
// that tile-rasterize reads those of its own tile at once.
import constants::BIN_TILES;
import constants::MASK_GROUP;
import constants::TILE_PX;
import layout::SplatRecord;
import layout::TileGrid;
import layout::TilePlan;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
import package::lib::splat_ellipse::{splatEllipse, touchedColumns, touchedRows};
import package::lib::splat_record::{axesOf, opacityOf};
import package::lib::tile_grid::columnCount;

const TILES = BIN_TILES * BIN_TILES;
const WORDS = MASK_GROUP / 32u;
const GROUP_WORDS = TILES * WORDS;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> grid: TileGrid;
@group(0) @binding(2) var<storage, read> tilePlan: TilePlan;
@group(0) @binding(3) var<storage, read> sortedBins: array<u32>;
@group(0) @binding(4) var<storage, read> sortedRecords: array<u32>;
@group(0) @binding(5) var<storage, read> records: array<SplatRecord>;
@group(0) @binding(6) var<storage, read_write> tileMasks: array<u32>;

var<workgroup> masks: array<atomic<u32>, GROUP_WORDS>;

@compute @workgroup_size(MASK_GROUP)
fn maskTiles(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let group = linearWorkgroup(workgroup, view.dispatchRow);
  if (group * MASK_GROUP >= tilePlan.pairCount) { return; }
  let pair = group * MASK_GROUP + lane;
  if (pair < tilePlan.pairCount) {
    let bin = sortedBins[pair];
    let splat = records[sortedRecords[pair]];
    // Pairs that were counted are of splats that reach the cutoff.
    if (opacityOf(splat) >= view.alphaCutoff) { maskPair(bin, splat, lane); }
  }
  workgroupBarrier();
  for (var word = lane; word < GROUP_WORDS; word += MASK_GROUP) {
    tileMasks[group * GROUP_WORDS + word] = atomicLoad(&masks[word]);
  }
}

fn maskPair(bin: u32, splat: SplatRecord, lane: u32) {
  let ellipse = splatEllipse(splat.centerPx, axesOf(splat), opacityOf(splat), view.alphaCutoff);
  let blockPx = f32(TILE_PX << tilePlan.binShift);
  let columnsOfBins = columnCount(grid, tilePlan.binShift);
  let left = f32(bin % columnsOfBins) * (BIN_TILES * blockPx);
  let top = f32(bin / columnsOfBins) * (BIN_TILES * blockPx);
  let rows = touchedRows(ellipse, top, blockPx, BIN_TILES);
  for (var row = rows.x; row <= rows.y; row++) {
    let firstRowPx = top + f32(row) * blockPx + 0.5;
    let columns = touchedColumns(ellipse, firstRowPx, firstRowPx + blockPx - 1.0, left, blockPx, BIN_TILES);
    for (var column = columns.x; column <= columns.y; column++) {
      let word = (u32(row) * BIN_TILES + u32(column)) * WORDS + lane / 32u;
      atomicOr(&masks[word], 1u << (lane % 32u));
    }
  }
}
