// First step of a radix pass: counts how often each digit occurs in each block of keys. Reads the
// keys and the sort's plan; writes digitCounts. One workgroup per block of SORT_BLOCK keys. Atomics
// in workgroup memory only count, so the result does not depend on their order. With NARROW one
// thread per block, which waits for no other.
import constants::DIGIT_BITS;
import constants::SORT_BLOCK;
@if(!NARROW) import constants::SORT_ITEMS;
import constants::SORT_WORKGROUP;
import layout::SortParameters;
import layout::SortPlan;
import package::lib::dispatch::linearWorkgroup;

const RADIX = 1u << DIGIT_BITS;

@group(0) @binding(0) var<uniform> parameters: SortParameters;
@group(0) @binding(1) var<storage, read> plan: SortPlan;
@group(0) @binding(2) var<storage, read> keys: array<u32>;
/// All blocks of digit 0, then of digit 1, …: a scan in this order turns counts into places.
@group(0) @binding(3) var<storage, read_write> digitCounts: array<u32>;

@if(!NARROW) var<workgroup> counts: array<atomic<u32>, RADIX>;

@if(!NARROW)
@compute @workgroup_size(SORT_WORKGROUP)
fn sortHistogram(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let block = linearWorkgroup(workgroup, parameters.dispatchRow);
  if (block >= plan.blockCount) { return; }
  let first = block * SORT_BLOCK + lane;
  // All are read before the first is counted: the reads then wait for memory together.
  var own: array<u32, SORT_ITEMS>;
  @unroll for (var item = 0u; item < SORT_ITEMS; item++) {
    let index = first + item * SORT_WORKGROUP;
    if (index < plan.keyCount) { own[item] = keys[index]; }
  }
  @unroll for (var item = 0u; item < SORT_ITEMS; item++) {
    let isKey = first + item * SORT_WORKGROUP < plan.keyCount;
    if (isKey) { atomicAdd(&counts[digitOf(own[item])], 1u); }
  }
  workgroupBarrier();
  for (var digit = lane; digit < RADIX; digit += SORT_WORKGROUP) {
    digitCounts[digit * plan.blockCount + block] = atomicLoad(&counts[digit]);
  }
}

@if(NARROW)
@compute @workgroup_size(SORT_WORKGROUP)
fn sortHistogram(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let block = linearWorkgroup(workgroup, parameters.dispatchRow) * SORT_WORKGROUP + lane;
  if (block >= plan.blockCount) { return; }
  var counts: array<u32, RADIX>;
  let start = block * SORT_BLOCK;
  let end = min(start + SORT_BLOCK, plan.keyCount);
  for (var index = start; index < end; index++) {
    counts[digitOf(keys[index])]++;
  }
  for (var digit = 0u; digit < RADIX; digit++) { digitCounts[digit * plan.blockCount + block] = counts[digit]; }
}

fn digitOf(key: u32) -> u32 {
  return (key >> parameters.digitShift) & (RADIX - 1u);
}
