// Sums over the threads of one workgroup of TILE_WORKGROUP threads. Used by the tile stages.
import constants::TILE_WORKGROUP;

/// More pairs than any buffer holds. Sums stop here: enough huge splats would exceed 32 bits.
const MOST_PAIRS = 0x40000000u;

var<workgroup> laneSums: array<u32, TILE_WORKGROUP>;

/// Returns the sum of `value` over this thread and all before it; both at most MOST_PAIRS.
fn scanLanes(lane: u32, value: u32) -> u32 {
  laneSums[lane] = value;
  for (var step = 1u; step < TILE_WORKGROUP; step <<= 1u) {
    workgroupBarrier();
    var before = 0u;
    if (lane >= step) { before = laneSums[lane - step]; }
    workgroupBarrier();
    laneSums[lane] = min(laneSums[lane] + before, MOST_PAIRS);
  }
  workgroupBarrier();
  return laneSums[lane];
}

/// Sum over all threads, after `scanLanes`.
fn sumOfLanes() -> u32 {
  let sum = laneSums[TILE_WORKGROUP - 1u];
  workgroupBarrier();
  return sum;
}
