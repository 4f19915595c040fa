// Replaces any number of counts by their exclusive prefix sums: n counts give n + 1 sums, the total
// last. Reads and writes `values` in place, and one sum per block. One workgroup per block of
// SCAN_WORKGROUP · SCAN_ITEMS counts. A hierarchical Blelloch scan, one dispatch per level, in
// which no workgroup waits for another. Going up, reduceBlocks sums each block; the last level is
// one block; going down, scanBlocks scans each block from the sum that the level above has for its
// start.
import constants::SCAN_WORKGROUP;
import constants::SCAN_ITEMS;
import layout::ScanParameters;
import package::lib::dispatch::linearWorkgroup;

const BLOCK = SCAN_WORKGROUP * SCAN_ITEMS;

@group(0) @binding(0) var<uniform> parameters: ScanParameters;
/// Number of counts, n. Values beyond it count as 0.
@group(0) @binding(1) var<storage, read> inputCount: u32;
@group(0) @binding(2) var<storage, read_write> values: array<u32>;
/// reduceBlocks writes each block's sum here; scanBlocks reads the sum of all blocks before it.
@group(0) @binding(3) var<storage, read_write> blockSums: array<u32>;

var<workgroup> tree: array<u32, SCAN_WORKGROUP>;

@compute @workgroup_size(SCAN_WORKGROUP)
fn reduceBlocks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let block = linearWorkgroup(workgroup, parameters.dispatchRow);
  if (block >= parameters.blockCount) { return; }
  var sum = 0u;
  // Strided, so that neighbouring lanes read neighbouring words; sums do not depend on the order.
  for (var item = 0u; item < SCAN_ITEMS; item++) { sum += load(block * BLOCK + item * SCAN_WORKGROUP + lane); }
  tree[lane] = sum;
  upSweep(lane);
  if (lane == 0u) { blockSums[block] = tree[SCAN_WORKGROUP - 1u]; }
}

@compute @workgroup_size(SCAN_WORKGROUP)
fn scanBlocks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let block = linearWorkgroup(workgroup, parameters.dispatchRow);
  if (block >= parameters.blockCount) { return; }
  scanBlock(block, lane, blockSums[block]);
}

/// Scans the level that is a single block.
@compute @workgroup_size(SCAN_WORKGROUP)
fn scanSingleBlock(@builtin(local_invocation_index) lane: u32) {
  scanBlock(0u, lane, 0u);
}

fn scanBlock(block: u32, lane: u32, start: u32) {
  let first = block * BLOCK + lane * SCAN_ITEMS;
  var items: array<u32, SCAN_ITEMS>;
  var sum = 0u;
  for (var item = 0u; item < SCAN_ITEMS; item++) {
    items[item] = load(first + item);
    sum += items[item];
  }
  tree[lane] = sum;
  upSweep(lane);
  downSweep(lane);
  var running = start + tree[lane];
  for (var item = 0u; item < SCAN_ITEMS; item++) {
    // There is one more sum than counts: the total.
    if (first + item <= inputCount) { values[first + item] = running; }
    running += items[item];
  }
}

fn load(index: u32) -> u32 {
  return select(0u, values[index], index < inputCount);
}

/// Sums in a tree; afterwards the last element holds the total.
fn upSweep(lane: u32) {
  for (var step = 1u; step < SCAN_WORKGROUP; step <<= 1u) {
    workgroupBarrier();
    let right = (lane + 1u) * 2u * step - 1u;
    if (right < SCAN_WORKGROUP) { tree[right] += tree[right - step]; }
  }
  workgroupBarrier();
}

/// Turns the tree of sums into exclusive prefix sums.
fn downSweep(lane: u32) {
  if (lane == 0u) { tree[SCAN_WORKGROUP - 1u] = 0u; }
  for (var step = SCAN_WORKGROUP / 2u; step > 0u; step >>= 1u) {
    workgroupBarrier();
    let right = (lane + 1u) * 2u * step - 1u;
    if (right < SCAN_WORKGROUP) {
      let left = tree[right - step];
      tree[right - step] = tree[right];
      tree[right] += left;
    }
  }
  workgroupBarrier();
}
