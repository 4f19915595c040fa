// Lists the pairs of visible splats and bins, front to back, and counts the digits of their keys
// for the first pass of the sort. Reads the numbers of pairs from tile-count, and the records;
// writes each pair's key (its bin) and its record, and the digit counts of each block of SORT_BLOCK
// pairs. One workgroup per block of pairs, not of splats, so that huge splats, which meet in few
// places of the order, keep no workgroup longer than others. Where one bin is the layer, each rank is
// a pair of its own.
import constants::DIGIT_BITS;
import constants::RANK_SAMPLES;
import constants::RANK_STEPS;
import constants::SORT_BLOCK;
import constants::TILE_COUNT_BLOCK;
import constants::TILE_EMIT_RUN;
import constants::TILE_WORKGROUP;
import layout::SplatRecord;
import layout::TileGrid;
import layout::TilePlan;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
import package::lib::splat_ellipse::splatEllipse;
import package::lib::splat_record::{axesOf, opacityOf};
import package::lib::tile_grid::{binColumns, binRows, columnCount, wholeShift};

/// The ranks of a block's pairs.
struct Ranks {
  first: u32,
  last: u32,
  /// From one sample to the next.
  apart: u32,
}

const RADIX = 1u << DIGIT_BITS;
/// Threads that look for one end of a block.
const END_THREADS = TILE_WORKGROUP / 2u;
/// Rounds that are enough for 2³² ranks, if four threads look for each end.
const END_ROUNDS = 16u;
/// Samples that each thread takes.
const LANE_SAMPLES = RANK_SAMPLES / TILE_WORKGROUP;
/// Pairs that all threads list in one round.
const ROUND = TILE_WORKGROUP * TILE_EMIT_RUN;
const ROUNDS = (SORT_BLOCK + ROUND - 1u) / ROUND;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> grid: TileGrid;
@group(0) @binding(2) var<storage, read> tilePlan: TilePlan;
@group(0) @binding(3) var<storage, read> order: array<u32>;
@group(0) @binding(4) var<storage, read> records: array<SplatRecord>;
@group(0) @binding(5) var<storage, read> pairOffsets: array<u32>;
@group(0) @binding(6) var<storage, read> blockPairs: array<u32>;
@group(0) @binding(7) var<storage, read_write> pairBins: array<u32>;
@group(0) @binding(8) var<storage, read_write> pairRecords: array<u32>;
@group(0) @binding(9) var<storage, read_write> digitCounts: array<u32>;

var<workgroup> counts: array<atomic<u32>, RADIX>;
/// Ranks of the block's first and last pair.
var<workgroup> ends: array<atomic<u32>, 2>;
/// Numbers of pairs before every rank of the block, or every second, third, …: threads look for the
/// splats of their pairs here first, as global memory takes longer.
var<workgroup> samples: array<u32, RANK_SAMPLES>;
/// Whether each rank is a pair.
var<private> isRanked: bool;

@compute @workgroup_size(TILE_WORKGROUP)
fn tileEmit(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let block = linearWorkgroup(workgroup, view.dispatchRow);
  let blockCount = (tilePlan.pairCount + SORT_BLOCK - 1u) / SORT_BLOCK;
  if (block >= blockCount) { return; }
  isRanked = tilePlan.binShift > 0u && tilePlan.binShift >= wholeShift(grid);
  let first = block * SORT_BLOCK;
  let ranks = findRanks(first, lane);
  takeSamples(ranks, lane);
  workgroupBarrier();
  let beyondLast = min(first + SORT_BLOCK, tilePlan.pairCount);
  for (var round = 0u; round < ROUNDS; round++) {
    let start = first + round * ROUND + lane * TILE_EMIT_RUN;
    emitRun(start, min(start + TILE_EMIT_RUN, beyondLast), ranks);
  }
  workgroupBarrier();
  for (var digit = lane; digit < RADIX; digit += TILE_WORKGROUP) {
    digitCounts[digit * blockCount + block] = atomicLoad(&counts[digit]);
  }
}

/// Finds the ranks of the block's first and last pair. Half of the threads look for one, half for the
/// other: in each round they look at as many ranks, evenly apart, and go on between two of them.
fn findRanks(first: u32, lane: u32) -> Ranks {
  let end = lane / END_THREADS;
  let pair = min(first + end * (SORT_BLOCK - 1u), tilePlan.pairCount - 1u);
  var low = 0u;
  var length = tilePlan.visibleCount;
  for (var round = 0u; round < END_ROUNDS; round++) {
    let apart = (length + END_THREADS - 1u) / END_THREADS;
    let rank = low + lane % END_THREADS * apart;
    if (rank < min(low + length, tilePlan.visibleCount)) {
      if (pairsBefore(rank) <= pair) { atomicMax(&ends[end], rank); }
    }
    workgroupBarrier();
    low = atomicLoad(&ends[end]);
    workgroupBarrier();
    if (apart == 1u) { break; }
    length = apart;
  }
  let found = vec2u(atomicLoad(&ends[0]), atomicLoad(&ends[1]));
  return Ranks(found.x, found.y, (found.y - found.x) / RANK_SAMPLES + 1u);
}

fn takeSamples(ranks: Ranks, lane: u32) {
  for (var i = 0u; i < LANE_SAMPLES; i++) {
    let sample = i * TILE_WORKGROUP + lane;
    let rank = ranks.first + sample * ranks.apart;
    // Behind the last rank: behind every pair.
    var pairs = 0xffffffffu;
    if (rank <= ranks.last) { pairs = pairsBefore(rank); }
    samples[sample] = pairs;
  }
}

/// Writes the pairs `start` ≤ pair < `end` of a block whose pairs belong to `ranks`.
fn emitRun(start: u32, end: u32, ranks: Ranks) {
  if (start >= end) { return; }
  let low = ranks.first + sampleOf(start) * ranks.apart;
  var rank = rankOf(start, low, min(low + ranks.apart - 1u, ranks.last));
  // Each splat has at least one of the pairs.
  for (var splat = 0u; splat < TILE_EMIT_RUN; splat++) {
    let splatEnd = min(end, endOfPairs(rank));
    emitSplat(order[tilePlan.visibleCount - 1u - rank], pairsBefore(rank), start, splatEnd);
    if (splatEnd >= end || rank >= ranks.last) { break; }
    rank++;
    // Most splats have pairs, but many thousands without any may follow each other: near ones
    // beside the image.
    if (endOfPairs(rank) <= splatEnd) { rank = rankOf(splatEnd, rank, ranks.last); }
  }
}

/// Writes the pairs of one splat, which begin at `splatStart`, that lie in `start` ≤ pair < `end`.
fn emitSplat(index: u32, splatStart: u32, start: u32, end: u32) {
  if (isRanked) {
    if (splatStart >= start && splatStart < end) { writePair(splatStart, 0u, index); }
    return;
  }
  let splat = records[index];
  let ellipse = splatEllipse(splat.centerPx, axesOf(splat), opacityOf(splat), view.alphaCutoff);
  let rows = binRows(ellipse, grid, tilePlan.binShift);
  var rowStart = splatStart;
  let beyondRows = rows.y + 1;
  for (var row = rows.x; row < beyondRows; row++) {
    if (rowStart >= end) { break; }
    let columns = binColumns(ellipse, row, grid, tilePlan.binShift);
    let rowEnd = rowStart + u32(max(0, columns.y - columns.x + 1));
    let first = max(start, rowStart);
    let beyond = min(end, rowEnd);
    for (var pair = first; pair < beyond; pair++) {
      writePair(pair, u32(row) * columnCount(grid, tilePlan.binShift) + u32(columns.x) + (pair - rowStart), index);
    }
    rowStart = rowEnd;
  }
  // This shader may round otherwise than the counting one. Excess pairs get a key behind all bins.
  let first = max(start, rowStart);
  for (var pair = first; pair < end; pair++) { writePair(pair, grid.binColumns * grid.binRows, index); }
}

fn writePair(pair: u32, bin: u32, index: u32) {
  pairBins[pair] = bin;
  pairRecords[pair] = index;
  atomicAdd(&counts[bin & (RADIX - 1u)], 1u);
}

/// Number of pairs of all splats nearer than `rank`.
fn pairsBefore(rank: u32) -> u32 {
  if (isRanked) { return rank; }
  return blockPairs[rank / TILE_COUNT_BLOCK] + pairOffsets[rank];
}

/// Number of pairs of all splats up to `rank`.
fn endOfPairs(rank: u32) -> u32 {
  if (rank + 1u >= tilePlan.visibleCount) { return tilePlan.pairCount; }
  return pairsBefore(rank + 1u);
}

/// Last sample whose pairs begin at or before `pair`.
fn sampleOf(pair: u32) -> u32 {
  var found = 0u;
  @unroll for (var step = 0u; step < RANK_STEPS; step++) {
    let half = u32(RANK_SAMPLES) >> (step + 1u);
    if (samples[found + half] <= pair) { found += half; }
  }
  return found;
}

/// Last rank in `low`…`high` whose pairs begin at or before `pair`.
fn rankOf(pair: u32, low: u32, high: u32) -> u32 {
  var found = low;
  var beyond = high + 1u;
  for (var step = 0u; step < 32u; step++) {
    if (beyond - found <= 1u) { break; }
    let middle = found + (beyond - found) / 2u;
    if (pairsBefore(middle) <= pair) { found = middle; } else { beyond = middle; }
  }
  return found;
}
