// Finds the tiles of its bin that each pair's splat may touch; the blocks of tiles, where bins are
// larger. Reads the sorted pairs and the records; writes a bit per pair and tile, or block. One
// workgroup per group of 256 pairs, one thread per pair; a group's words lie together by tile, so
// that tile-rasterize reads the words of its own tile at once. With NARROW each thread of a group
// finds a word of each tile, 32 pairs one after another.
import constants::BIN_TILES;
import constants::MASK_GROUP;
import constants::MASK_WORKGROUP;
import constants::TILE_PX;
import layout::SplatRecord;
import layout::TileGrid;
import layout::TilePlan;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
import package::lib::splat_ellipse::{SplatEllipse, splatEllipse, touchedColumns, touchedRows};
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

@if(!NARROW) var<workgroup> masks: array<atomic<u32>, GROUP_WORDS>;

@compute @workgroup_size(MASK_WORKGROUP)
fn maskTiles(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let group = linearWorkgroup(workgroup, view.dispatchRow);
  if (group * MASK_GROUP >= tilePlan.pairCount) { return; }
  @if(!NARROW) maskTogether(group, lane);
  @if(NARROW) maskAlone(group, lane);
}

@if(!NARROW)
fn maskTogether(group: u32, lane: u32) {
  let tiles = tilesOfPair(group * MASK_GROUP + lane);
  let rows = tiles.rows;
  let beyondRows = rows.y + 1;
  for (var row = rows.x; row < beyondRows; row++) {
    let columns = columnsOf(tiles, row);
    let beyondColumns = columns.y + 1;
    for (var column = columns.x; column < beyondColumns; column++) {
      let word = (u32(row) * BIN_TILES + u32(column)) * WORDS + lane / 32u;
      atomicOr(&masks[word], 1u << (lane % 32u));
    }
  }
  workgroupBarrier();
  for (var word = lane; word < GROUP_WORDS; word += MASK_GROUP) {
    tileMasks[group * GROUP_WORDS + word] = atomicLoad(&masks[word]);
  }
}

@if(NARROW)
fn maskAlone(group: u32, lane: u32) {
  var masks: array<u32, TILES>;
  for (var bit = 0u; bit < 32u; bit++) {
    let tiles = tilesOfPair(group * MASK_GROUP + lane * 32u + bit);
    let rows = tiles.rows;
    let beyondRows = rows.y + 1;
    for (var row = rows.x; row < beyondRows; row++) {
      let columns = columnsOf(tiles, row);
      let beyondColumns = columns.y + 1;
      for (var column = columns.x; column < beyondColumns; column++) {
        masks[u32(row) * BIN_TILES + u32(column)] |= 1u << bit;
      }
    }
  }
  for (var tile = 0u; tile < TILES; tile++) { tileMasks[group * GROUP_WORDS + tile * WORDS + lane] = masks[tile]; }
}

/// A pair's splat and the rows of its bin's tiles that the splat may touch.
struct PairTiles {
  ellipse: SplatEllipse,
  left: f32,
  top: f32,
  /// First and last row of tiles; last < first if there are none.
  rows: vec2i,
}

fn tilesOfPair(pair: u32) -> PairTiles {
  var tiles: PairTiles;
  tiles.rows = vec2i(0, -1);
  if (pair >= tilePlan.pairCount) { return tiles; }
  let splat = records[sortedRecords[pair]];
  // Pairs that were counted are of splats that reach the cutoff.
  if (opacityOf(splat) < view.alphaCutoff) { return tiles; }
  tiles.ellipse = splatEllipse(splat.centerPx, axesOf(splat), opacityOf(splat), view.alphaCutoff);
  let bin = sortedBins[pair];
  let columnsOfBins = columnCount(grid, tilePlan.binShift);
  tiles.left = f32(bin % columnsOfBins) * (BIN_TILES * blockPx());
  tiles.top = f32(bin / columnsOfBins) * (BIN_TILES * blockPx());
  tiles.rows = touchedRows(tiles.ellipse, tiles.top, blockPx(), BIN_TILES);
  return tiles;
}

fn columnsOf(tiles: PairTiles, row: i32) -> vec2i {
  let firstRowPx = tiles.top + f32(row) * blockPx() + 0.5;
  return touchedColumns(tiles.ellipse, firstRowPx, firstRowPx + blockPx() - 1.0, tiles.left, blockPx(), BIN_TILES);
}

fn blockPx() -> f32 {
  return f32(TILE_PX << tilePlan.binShift);
}
