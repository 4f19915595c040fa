// Prefix sums over a run of counts, by one workgroup of SCAN_WORKGROUP threads: the counts of a
// longer list follow run by run, so that its scan takes a single dispatch, and no workgroup waits for
// another. With NARROW for a workgroup of one thread,
// without barriers.
@if(!NARROW) import constants::SCAN_GROUP;
@if(!NARROW) import constants::SCAN_GROUPS;
import constants::SCAN_ITEMS;
import constants::SCAN_WORKGROUP;

/// Counts that the workgroup scans at a time.
const SCAN_RUN = SCAN_WORKGROUP * SCAN_ITEMS;

/// The run's counts, then their sums. Threads have counts that lie `lanes` apart, so that neighbours
/// read and write neighbouring words, but sum up neighbouring counts; this array turns one into the
/// other.
@if(!NARROW) var<workgroup> run: array<u32, SCAN_RUN + SCAN_RUN / 32u>;
@if(!NARROW) var<workgroup> threadSums: array<u32, SCAN_WORKGROUP>;
@if(!NARROW) var<workgroup> groupSums: array<u32, SCAN_GROUPS>;

struct RunSums {
  /// For each count, the sum of all before it.
  before: array<u32, SCAN_ITEMS>,
  total: u32,
}

/// Scans `lanes` · SCAN_ITEMS counts by as many successive threads: the whole workgroup for one run,
/// or a multiple of SCAN_GROUP threads for each of several. Count `item` of a thread has the place
/// `item * lanes + lane % lanes` in its run.
@if(!NARROW)
fn scanRun(lane: u32, lanes: u32, counts: array<u32, SCAN_ITEMS>) -> RunSums {
  // Each thread reads the words again that it fills here, so no barrier precedes the next run.
  let first = lane / lanes * lanes * SCAN_ITEMS + lane % lanes;
  @unroll for (var item = 0u; item < SCAN_ITEMS; item++) { run[spread(first + item * lanes)] = counts[item]; }
  workgroupBarrier();

  var sum = 0u;
  @unroll for (var item = 0u; item < SCAN_ITEMS; item++) { sum += run[spread(lane * SCAN_ITEMS + item)]; }
  threadSums[lane] = sum;
  workgroupBarrier();

  // All sums are read, needed or not, so that no read waits for another.
  let group = lane / SCAN_GROUP;
  let groupStart = group * SCAN_GROUP;
  var running = 0u;
  @unroll for (var i = 0u; i < SCAN_GROUP; i++) {
    running += select(0u, threadSums[groupStart + i], groupStart + i < lane);
  }
  if (lane % SCAN_GROUP == SCAN_GROUP - 1u) { groupSums[group] = running + sum; }
  workgroupBarrier();

  let runGroups = lanes / SCAN_GROUP;
  let firstGroup = group / runGroups * runGroups;
  let endGroup = firstGroup + runGroups;
  var total = 0u;
  @unroll for (var other = 0u; other < SCAN_GROUPS; other++) {
    let otherSum = select(0u, groupSums[other], other >= firstGroup && other < endGroup);
    running += select(0u, otherSum, other < group);
    total += otherSum;
  }
  @unroll for (var item = 0u; item < SCAN_ITEMS; item++) {
    let place = spread(lane * SCAN_ITEMS + item);
    let count = run[place];
    run[place] = running;
    running += count;
  }
  workgroupBarrier();

  var before: array<u32, SCAN_ITEMS>;
  @unroll for (var item = 0u; item < SCAN_ITEMS; item++) { before[item] = run[spread(first + item * lanes)]; }
  return RunSums(before, total);
}

/// Skips a word after every 32, so that lanes SCAN_ITEMS words apart hit different banks.
@if(!NARROW)
fn spread(place: u32) -> u32 {
  return place + place / 32u;
}

@if(NARROW)
fn scanRun(lane: u32, lanes: u32, counts: array<u32, SCAN_ITEMS>) -> RunSums {
  var before: array<u32, SCAN_ITEMS>;
  var total = 0u;
  @unroll for (var item = 0u; item < SCAN_ITEMS; item++) {
    before[item] = total;
    total += counts[item];
  }
  return RunSums(before, total);
}
