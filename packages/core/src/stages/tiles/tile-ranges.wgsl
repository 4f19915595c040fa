// Finds each bin's part of the sorted pairs, and puts the bins in the order in which they are
// drawn: long lists first, so that no workgroup is still at work when all others are done. Reads
// the sorted keys; writes the first pair of each bin, and the order. One workgroup; one thread per
// bin and round.
import constants::SEARCHES;
import constants::TILE_WORKGROUP;
import layout::TileGrid;
import layout::TilePlan;

@group(0) @binding(0) var<uniform> grid: TileGrid;
@group(0) @binding(1) var<storage, read> tilePlan: TilePlan;
@group(0) @binding(2) var<storage, read> sortedBins: array<u32>;
/// One more than there are bins: the last bin's end.
@group(0) @binding(3) var<storage, read_write> binStarts: array<u32>;
@group(0) @binding(4) var<storage, read_write> binOrder: array<u32>;

/// Classes of lengths: four per power of two.
const CLASSES = 128u;
/// Bins whose first pairs all threads find at the same time.
const ROUND = SEARCHES * TILE_WORKGROUP;

/// Bins per class; then the next place for a bin of each class.
var<workgroup> places: array<atomic<u32>, CLASSES>;

@compute @workgroup_size(TILE_WORKGROUP)
fn tileRanges(@builtin(local_invocation_index) lane: u32) {
  let bins = grid.binColumns * grid.binRows;
  for (var first = 0u; first <= bins; first += ROUND) { findStarts(first + lane, bins); }
  storageBarrier();
  for (var bin = lane; bin < bins; bin += TILE_WORKGROUP) { atomicAdd(&places[classOf(bin)], 1u); }
  workgroupBarrier();
  if (lane == 0u) {
    var running = 0u;
    for (var each = 0u; each < CLASSES; each++) {
      let count = atomicLoad(&places[each]);
      atomicStore(&places[each], running);
      running += count;
    }
  }
  workgroupBarrier();
  // Bins of one class may come in any order: it changes only when each is drawn.
  for (var bin = lane; bin < bins; bin += TILE_WORKGROUP) {
    binOrder[atomicAdd(&places[classOf(bin)], 1u)] = bin;
  }
}

/// Finds the first places of the sorted pairs with keys of at least `first`, and of the bins that follow
/// it TILE_WORKGROUP apart, in step: a search alone waits for each of its reads.
fn findStarts(first: u32, bins: u32) {
  var low: array<u32, SEARCHES>;
  var high: array<u32, SEARCHES>;
  @unroll for (var i = 0u; i < SEARCHES; i++) { high[i] = tilePlan.pairCount; }
  for (var reach = tilePlan.pairCount; reach > 0u; reach >>= 1u) {
    @unroll for (var i = 0u; i < SEARCHES; i++) {
      let middle = low[i] + (high[i] - low[i]) / 2u;
      let isBefore = low[i] < high[i] && sortedBins[middle] < first + i * TILE_WORKGROUP;
      if (isBefore) { low[i] = middle + 1u; } else { high[i] = middle; }
    }
  }
  @unroll for (var i = 0u; i < SEARCHES; i++) {
    let bin = first + i * TILE_WORKGROUP;
    if (bin <= bins) { binStarts[bin] = low[i]; }
  }
}

/// Class of a bin's length: 0 for the longest.
fn classOf(bin: u32) -> u32 {
  let length = binStarts[bin + 1u] - binStarts[bin];
  if (length == 0u) { return CLASSES - 1u; }
  let exponent = firstLeadingBit(length);
  let fraction = extractBits(length << (31u - exponent), 29u, 2u);
  return CLASSES - 2u - min(CLASSES - 2u, 4u * exponent + fraction);
}
