// Sizes the passes of the sort by the number of keys, on the GPU, so that this number is never read
// back. Reads the number of keys; writes the sort's plan and the dispatch over blocks. One thread.
import constants::SORT_BLOCK;
import layout::SortParameters;
import layout::SortPlan;
import package::lib::dispatch::dispatchSize;

@group(0) @binding(0) var<uniform> parameters: SortParameters;
@group(0) @binding(1) var<storage, read> keyCount: u32;
@group(0) @binding(2) var<storage, read_write> plan: SortPlan;
@group(0) @binding(3) var<storage, read_write> blockDispatch: array<u32, 3>;

@compute @workgroup_size(1)
fn planSort() {
  // Keys beyond the capacity would be written past the buffers' end; the host ensures that there
  // are none.
  let count = min(keyCount, parameters.capacity);
  let blocks = (count + SORT_BLOCK - 1u) / SORT_BLOCK;
  plan = SortPlan(count, blocks);
  let size = dispatchSize(blocks, parameters.dispatchRow);
  blockDispatch = array<u32, 3>(size.x, size.y, size.z);
}
