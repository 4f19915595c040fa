// Second step of a radix pass: turns the digit counts of all blocks into places. Reads the sort's
// plan; replaces the counts of each digit by their exclusive sums over the blocks, in place, and
// writes each digit's total. A workgroup takes one digit, or several where few blocks are possible,
// and as many blocks as there are: a pass takes three dispatches at any size, and no workgroup
// waits for another. sort-scatter adds the digits' own starts.
import constants::DIGIT_BITS;
import constants::SCAN_WORKGROUP;
import constants::SCAN_ITEMS;
import layout::SortParameters;
import layout::SortPlan;
import package::lib::dispatch::linearWorkgroup;

const RADIX = 1u << DIGIT_BITS;
/// Counts that the workgroup scans at a time.
const RUN = SCAN_WORKGROUP * SCAN_ITEMS;
/// Threads whose sums are added one by one: two barriers; a tree of 256 threads takes 16.
const GROUP = 16u;

@group(0) @binding(0) var<uniform> parameters: SortParameters;
@group(0) @binding(1) var<storage, read> plan: SortPlan;
/// All blocks of digit 0, then all blocks of digit 1, …
@group(0) @binding(2) var<storage, read_write> digitCounts: array<u32>;
@group(0) @binding(3) var<storage, read_write> digitTotals: array<u32>;

/// The run's counts, then their sums. Memory is read by neighbouring lanes at neighbouring words,
/// but summed by one lane over neighbouring words; this array turns one into the other.
var<workgroup> run: array<u32, RUN + RUN / 32u>;
var<workgroup> threadSums: array<u32, SCAN_WORKGROUP>;
var<workgroup> groupSums: array<u32, SCAN_WORKGROUP / GROUP>;

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
  let runPlace = lane / lanes * digitRun;
  let group = lane / GROUP;
  let groupStart = group * GROUP;
  let digitGroups = lanes / GROUP;
  let firstGroup = group / digitGroups * digitGroups;
  let endGroup = firstGroup + digitGroups;
  var total = 0u;
  for (var start = 0u; start < plan.blockCount; start += digitRun) {
    for (var item = 0u; item < SCAN_ITEMS; item++) {
      let place = item * lanes + lane % lanes;
      var count = 0u;
      if (start + place < end) { count = digitCounts[row + start + place]; }
      run[spread(runPlace + place)] = count;
    }
    workgroupBarrier();

    var sum = 0u;
    for (var item = 0u; item < SCAN_ITEMS; item++) { sum += run[spread(lane * SCAN_ITEMS + item)]; }
    threadSums[lane] = sum;
    workgroupBarrier();

    var before = 0u;
    for (var other = groupStart; other < lane; other++) { before += threadSums[other]; }
    if (lane % GROUP == GROUP - 1u) { groupSums[group] = before + sum; }
    workgroupBarrier();

    var runTotal = 0u;
    for (var other = firstGroup; other < endGroup; other++) {
      if (other == group) { before += runTotal; }
      runTotal += groupSums[other];
    }
    var running = total + before;
    for (var item = 0u; item < SCAN_ITEMS; item++) {
      let place = spread(lane * SCAN_ITEMS + item);
      let count = run[place];
      run[place] = running;
      running += count;
    }
    total += runTotal;
    workgroupBarrier();

    // Each lane reads the words that it fills for the next run, so no barrier follows.
    for (var item = 0u; item < SCAN_ITEMS; item++) {
      let place = item * lanes + lane % lanes;
      if (start + place < end) { digitCounts[row + start + place] = run[spread(runPlace + place)]; }
    }
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

/// Skips a word after every 32, so that lanes SCAN_ITEMS words apart hit different banks.
fn spread(place: u32) -> u32 {
  return place + place / 32u;
}
