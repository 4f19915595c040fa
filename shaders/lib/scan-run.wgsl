// Prefix sums over a run of counts, by one workgroup of SCAN_WORKGROUP threads: the counts of a
// longer list follow run by run, so that its scan takes a single dispatch, and no workgroup waits for
// another. Used by plan-cull, plan-project and sort-scan. With NARROW for a workgroup of one thread,
// without barriers.
import constants::SCAN_ITEMS;
import constants::SCAN_WORKGROUP;

/// Counts that the workgroup scans at a time.
const SCAN_RUN = SCAN_WORKGROUP * SCAN_ITEMS;
/// Threads whose sums are added one by one: two barriers; a tree of 256 threads takes 16.
@if(!NARROW) const GROUP = 16u;

/// The run's counts, then their sums. Threads have counts that lie `lanes` apart, so that neighbours
/// read and write neighbouring words, but sum up neighbouring counts; this array turns one into the
/// other.
@if(!NARROW) var<workgroup> run: array<u32, SCAN_RUN + SCAN_RUN / 32u>;
@if(!NARROW) var<workgroup> threadSums: array<u32, SCAN_WORKGROUP>;
@if(!NARROW) var<workgroup> groupSums: array<u32, SCAN_WORKGROUP / GROUP>;

struct RunSums {
  /// For each count, the sum of all before it.
  before: array<u32, SCAN_ITEMS>,
  total: u32,
}

/// Scans `lanes` · SCAN_ITEMS counts by as many successive threads: the whole workgroup for one run,
/// or a multiple of GROUP threads for each of several. Count `item` of a thread has the place
/// `item * lanes + lane % lanes` in its run.
@if(!NARROW)
fn scanRun(lane: u32, lanes: u32, counts: array<u32, SCAN_ITEMS>) -> RunSums {
  // Each thread reads the words again that it fills here, so no barrier precedes the next run.
  let first = lane / lanes * lanes * SCAN_ITEMS + lane % lanes;
  @unroll for (var item = 0u; item < SCAN_ITEMS; item++) { run[spread(first + item * lanes)] = counts[item]; }
  workgroupBarrier();

  var sum = 0u;
  for (var item = 0u; item < SCAN_ITEMS; item++) { sum += run[spread(lane * SCAN_ITEMS + item)]; }
  threadSums[lane] = sum;
  workgroupBarrier();

  let group = lane / GROUP;
  let groupStart = group * GROUP;
  var running = 0u;
  for (var other = groupStart; other < lane; other++) { running += threadSums[other]; }
  if (lane % GROUP == GROUP - 1u) { groupSums[group] = running + sum; }
  workgroupBarrier();

  let runGroups = lanes / GROUP;
  let firstGroup = group / runGroups * runGroups;
  let endGroup = firstGroup + runGroups;
  var total = 0u;
  for (var other = firstGroup; other < endGroup; other++) {
    if (other == group) { running += total; }
    total += groupSums[other];
  }
  for (var item = 0u; item < SCAN_ITEMS; item++) {
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
