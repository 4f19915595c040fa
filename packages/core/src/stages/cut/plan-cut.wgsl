// Finds the least shift of thresholds at which the cuts of a frame draw no more than its budget, in
// two steps: of 64 codes, and then of one. Reads the counts of cut-count and clears them; writes
// the plan. One workgroup, one thread per bin. Where no shift is enough, the largest is taken.
import constants::CUT_BINS;
import constants::CUT_COPIES;
import constants::SHIFT_STEP;
import layout::CutPlan;

@group(0) @binding(0) var<storage, read_write> cutPlan: CutPlan;
@group(0) @binding(1) var<storage, read_write> cutCounts: array<u32, CUT_BINS * CUT_COPIES>;

var<workgroup> sums: array<u32, CUT_BINS>;
/// Bins from the first that fits on.
var<workgroup> fitting: atomic<u32>;

@compute @workgroup_size(CUT_BINS)
fn planCut(@builtin(local_invocation_index) lane: u32) {
  var sum = 0u;
  for (var copy = 0u; copy < CUT_COPIES; copy++) {
    sum += cutCounts[copy * CUT_BINS + lane];
    cutCounts[copy * CUT_BINS + lane] = 0u;
  }
  for (var stride = 1u; stride < CUT_BINS; stride <<= 1u) {
    sums[lane] = sum;
    workgroupBarrier();
    if (lane >= stride) { sum += sums[lane - stride]; }
    workgroupBarrier();
  }
  if (sum <= cutPlan.budget) { atomicMax(&fitting, CUT_BINS - lane); }
  workgroupBarrier();
  if (lane == 0u) {
    let bin = CUT_BINS - max(atomicLoad(&fitting), 1u);
    cutPlan.shift = cutPlan.base + bin * cutPlan.step;
    // The next steps begin behind the last bin that does not fit.
    if (bin > 0u) { cutPlan.base = cutPlan.shift - (SHIFT_STEP - 1u); }
    cutPlan.step = 1u;
  }
}
