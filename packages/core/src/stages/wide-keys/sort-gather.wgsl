// Between the passes of a sort by two words: puts the upper words into the order that the lower ones
// have given. Reads the upper words, the order and the sort's plan; writes keys. One workgroup per
// block of SORT_BLOCK keys. With NARROW one thread per block.
import constants::SORT_BLOCK;
@if(!NARROW) import constants::SORT_ITEMS;
import constants::SORT_WORKGROUP;
import layout::SortParameters;
import layout::SortPlan;
import package::lib::dispatch::linearWorkgroup;

@group(0) @binding(0) var<uniform> parameters: SortParameters;
@group(0) @binding(1) var<storage, read> plan: SortPlan;
@group(0) @binding(2) var<storage, read> upperKeys: array<u32>;
@group(0) @binding(3) var<storage, read> payloads: array<u32>;
@group(0) @binding(4) var<storage, read_write> keys: array<u32>;

@if(!NARROW)
@compute @workgroup_size(SORT_WORKGROUP)
fn sortGather(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let block = linearWorkgroup(workgroup, parameters.dispatchRow);
  if (block >= plan.blockCount) { return; }
  for (var item = 0u; item < SORT_ITEMS; item++) {
    let index = block * SORT_BLOCK + item * SORT_WORKGROUP + lane;
    if (index < plan.keyCount) { keys[index] = upperKeys[payloads[index]]; }
  }
}

@if(NARROW)
@compute @workgroup_size(SORT_WORKGROUP)
fn sortGather(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let block = linearWorkgroup(workgroup, parameters.dispatchRow) * SORT_WORKGROUP + lane;
  if (block >= plan.blockCount) { return; }
  let start = block * SORT_BLOCK;
  let end = min(start + SORT_BLOCK, plan.keyCount);
  for (var index = start; index < end; index++) { keys[index] = upperKeys[payloads[index]]; }
}
