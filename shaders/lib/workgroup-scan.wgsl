// Sums over the threads of one workgroup of TILE_WORKGROUP threads.
import constants::TILE_WORKGROUP;

/// More pairs than any buffer holds. Sums stop here: enough huge splats would exceed 32 bits.
const MOST_PAIRS = 0x40000000u;

/// Threads whose values are added one by one: two barriers; a tree of 256 threads takes 16.
const GROUP = min(16u, TILE_WORKGROUP);
const GROUPS = TILE_WORKGROUP / GROUP;

var<workgroup> laneValues: array<u32, TILE_WORKGROUP>;
var<workgroup> groupSums: array<u32, GROUPS>;

/// Returns the sum of `value` over this thread and all before it; both at most MOST_PAIRS.
fn scanLanes(lane: u32, value: u32) -> u32 {
  laneValues[lane] = value;
  workgroupBarrier();
  let group = lane / GROUP;
  let groupStart = group * GROUP;
  var sum = value;
  for (var other = groupStart; other < lane; other++) { sum = min(sum + laneValues[other], MOST_PAIRS); }
  if (lane % GROUP == GROUP - 1u) { groupSums[group] = sum; }
  workgroupBarrier();
  for (var other = 0u; other < group; other++) { sum = min(sum + groupSums[other], MOST_PAIRS); }
  return sum;
}

/// Sum over all threads, after `scanLanes`.
fn sumOfLanes() -> u32 {
  var sum = 0u;
  for (var group = 0u; group < GROUPS; group++) { sum = min(sum + groupSums[group], MOST_PAIRS); }
  return sum;
}
