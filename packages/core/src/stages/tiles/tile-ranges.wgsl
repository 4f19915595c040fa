// Finds each bin's part of the sorted pairs, and puts the bins in the order in which they are
// drawn: long lists first, so that no workgroup is still at work when all others are done. Reads
// the sorted keys; writes the first pair of each bin, and the order. One workgroup; one thread per
// bin and round.
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

/// Bins per class; then the next place for a bin of each class.
var<workgroup> places: array<atomic<u32>, CLASSES>;

@compute @workgroup_size(TILE_WORKGROUP)
fn tileRanges(@builtin(local_invocation_index) lane: u32) {
  let bins = grid.binColumns * grid.binRows;
  for (var bin = lane; bin <= bins; bin += TILE_WORKGROUP) { binStarts[bin] = firstPairFrom(bin); }
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

/// First place of the sorted pairs with a key of at least `bin`.
fn firstPairFrom(bin: u32) -> u32 {
  var low = 0u;
  var high = tilePlan.pairCount;
  for (var step = 0u; step < 32u; step++) {
    if (low >= high) { break; }
    let middle = low + (high - low) / 2u;
    if (sortedBins[middle] < bin) { low = middle + 1u; } else { high = middle; }
  }
  return low;
}

/// Class of a bin's length: 0 for the longest.
fn classOf(bin: u32) -> u32 {
  let length = binStarts[bin + 1u] - binStarts[bin];
  if (length == 0u) { return CLASSES - 1u; }
  let exponent = firstLeadingBit(length);
  let fraction = extractBits(length << (31u - exponent), 29u, 2u);
  return CLASSES - 2u - min(CLASSES - 2u, 4u * exponent + fraction);
}
