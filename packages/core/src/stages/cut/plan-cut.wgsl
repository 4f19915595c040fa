// Finds the least shift of thresholds at which the cuts of a frame draw no more than its budget. Reads
// the counts of cut-count and clears them; writes the plan. One workgroup, one thread per run of
// bins. Where no shift is enough, the largest is taken.
import constants::CUT_BINS;
import constants::CUT_COPIES;
import constants::PLAN_WORKGROUP;
import layout::CutPlan;

@group(0) @binding(0) var<storage, read_write> cutPlan: CutPlan;
@group(0) @binding(1) var<storage, read_write> cutCounts: array<u32, CUT_BINS * CUT_COPIES>;

/// Bins per thread.
const RUN = CUT_BINS / PLAN_WORKGROUP;

var<workgroup> sums: array<u32, PLAN_WORKGROUP>;
/// Bins from the first that fits on.
var<workgroup> fitting: atomic<u32>;

@compute @workgroup_size(PLAN_WORKGROUP)
fn planCut(@builtin(local_invocation_index) lane: u32) {
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
    drawn += counts[i];
    if (drawn <= cutPlan.budget) { atomicMax(&fitting, CUT_BINS - (lane * RUN + i)); }
  }
  workgroupBarrier();
  if (lane == 0u) { cutPlan.shift = cutPlan.base + CUT_BINS - max(atomicLoad(&fitting), 1u); }
}
