// Second step of a radix pass: turns the digit counts of all blocks into places. Reads the sort's
// plan; replaces the counts of each digit by their exclusive sums over the blocks, in place, and
// writes each digit's total. A workgroup takes one digit, or several where few blocks are possible,
// and as many blocks as there are: a pass takes three dispatches at any size, and no workgroup
// waits for another. sort-scatter adds the digits' own starts.
import constants::DIGIT_BITS;
import constants::SCAN_ITEMS;
import constants::SCAN_WORKGROUP;
import layout::SortParameters;
import layout::SortPlan;
import package::lib::dispatch::linearWorkgroup;
import package::lib::scan_run::scanRun;

const RADIX = 1u << DIGIT_BITS;

@group(0) @binding(0) var<uniform> parameters: SortParameters;
@group(0) @binding(1) var<storage, read> plan: SortPlan;
/// All blocks of digit 0, then all blocks of digit 1, …
@group(0) @binding(2) var<storage, read_write> digitCounts: array<u32>;
@group(0) @binding(3) var<storage, read_write> digitTotals: array<u32>;

@compute @workgroup_size(SCAN_WORKGROUP)
fn sortScan(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let lanes = parameters.scanLanes;
  let firstDigit = linearWorkgroup(workgroup, parameters.dispatchRow) * (SCAN_WORKGROUP / lanes);
  if (firstDigit >= RADIX) { return; }
  if (lanes == 1u) {
    if (firstDigit + lane < RADIX) { scanAlone(firstDigit + lane); }
    return;
  }
  let digit = firstDigit + lane / lanes;
  let row = digit * plan.blockCount;
  // Lanes without a digit take part in barriers only.
  let end = select(0u, plan.blockCount, digit < RADIX);
  let digitRun = lanes * SCAN_ITEMS;
  var total = 0u;
  for (var start = 0u; start < plan.blockCount; start += digitRun) {
    let first = start + lane % lanes;
    var counts: array<u32, SCAN_ITEMS>;
    @unroll for (var item = 0u; item < SCAN_ITEMS; item++) {
      let block = first + item * lanes;
      var count = 0u;
      if (block < end) { count = digitCounts[row + block]; }
      counts[item] = count;
    }
    let sums = scanRun(lane, lanes, counts);
    @unroll for (var item = 0u; item < SCAN_ITEMS; item++) {
      let block = first + item * lanes;
      if (block < end) { digitCounts[row + block] = total + sums.before[item]; }
    }
    total += sums.total;
  }
  if (lane % lanes == 0u && digit < RADIX) { digitTotals[digit] = total; }
}

/// Scans a digit's counts in one thread. It waits for memory once per SCAN_ITEMS counts.
fn scanAlone(digit: u32) {
  let row = digit * plan.blockCount;
  var total = 0u;
  for (var start = 0u; start < plan.blockCount; start += SCAN_ITEMS) {
    var counts: array<u32, SCAN_ITEMS>;
    for (var item = 0u; item < SCAN_ITEMS; item++) {
      // Written without a count, too: in Dawn on SwiftShader, "counts" kept the last turn's values.
      var count = 0u;
      if (start + item < plan.blockCount) { count = digitCounts[row + start + item]; }
      counts[item] = count;
    }
    for (var item = 0u; item < SCAN_ITEMS; item++) {
      if (start + item < plan.blockCount) { digitCounts[row + start + item] = total; }
      total += counts[item];
    }
  }
  digitTotals[digit] = total;
}
