// Finds the least shift of thresholds from which on the cuts of a frame draw no more than its budget.
// Reads the counts of cut-count and clears them; writes the plan. One workgroup, one thread per run of
// bins. If even the last shift draws more, the last shift is taken.
//
// Wide GPUs count all shifts, once. Elsewhere this runs after each of a frame's two counts. The first
// begins a little below the last frame's shift. If it finds a shift that draws more than the budget,
// lower shifts cannot be the answer, and the second count does nothing. So all give the same shift.
import constants::COUNT_ALL;
import constants::COUNT_ANEW;
import constants::COUNT_NOTHING;
import constants::CUT_BINS;
import constants::CUT_COPIES;
import constants::PLAN_WORKGROUP;
import constants::SHIFT_MARGIN;
import layout::CutPlan;

@group(0) @binding(0) var<storage, read_write> cutPlan: CutPlan;
@group(0) @binding(1) var<storage, read_write> cutCounts: array<u32, CUT_BINS * CUT_COPIES>;

/// Bins per thread.
const RUN = CUT_BINS / PLAN_WORKGROUP;

var<workgroup> sums: array<u32, PLAN_WORKGROUP>;
/// The shift after the last one that draws more than the budget; 0 if none does.
var<workgroup> behindLast: atomic<u32>;
var<workgroup> next: u32;

@compute @workgroup_size(PLAN_WORKGROUP)
fn planCut(@builtin(local_invocation_index) lane: u32) {
  if (lane == 0u) { next = cutPlan.next; }
  if (workgroupUniformLoad(&next) == COUNT_NOTHING) {
    if (lane == 0u) { cutPlan.next = COUNT_ANEW; }
    return;
  }
  let least = cutPlan.leastShift;
  let first = max(cutPlan.base, least);
  let last = least + CUT_BINS - 1u;
  var counts: array<u32, RUN>;
  for (var copy = 0u; copy < CUT_COPIES; copy++) {
    for (var i = 0u; i < RUN; i++) {
      let word = copy * CUT_BINS + lane * RUN + i;
      counts[i] += cutCounts[word];
      cutCounts[word] = 0u;
    }
  }
  var inRun = 0u;
  for (var i = 0u; i < RUN; i++) { inRun += counts[i]; }
  var sum = inRun;
  for (var stride = 1u; stride < PLAN_WORKGROUP; stride <<= 1u) {
    sums[lane] = sum;
    workgroupBarrier();
    if (lane >= stride) { sum += sums[lane - stride]; }
    workgroupBarrier();
  }
  var drawn = sum - inRun;
  for (var i = 0u; i < RUN; i++) {
    let shift = first + lane * RUN + i;
    drawn += counts[i];
    if (drawn > cutPlan.budget && shift <= last) { atomicMax(&behindLast, shift + 1u); }
  }
  workgroupBarrier();
  if (lane != 0u) { return; }
  let found = atomicLoad(&behindLast);
  if (found == 0u && first > least) {
    cutPlan.base = 0u;
    cutPlan.next = COUNT_ALL;
    return;
  }
  let shift = clamp(found, least, last);
  cutPlan.shift = shift;
  cutPlan.base = shift - SHIFT_MARGIN;
  if (next == COUNT_ALL) {
    cutPlan.next = COUNT_ANEW;
  } else {
    cutPlan.next = COUNT_NOTHING;
  }
}
