// Sizes the passes of the sort by the number of keys, on the GPU, so that this number is never read back.
// Reads the number of keys; writes the sort's plan, the number of digit counts to scan and the dispatch over tiles. One
// thread.
import constants::SORT_TILE;
import layout::SortParameters;
import layout::SortPlan;
import package::lib::dispatch::dispatchSize;

@group(0) @binding(0) var<uniform> parameters: SortParameters;
@group(0) @binding(1) var<storage, read> keyCount: u32;
@group(0) @binding(2) var<storage, read_write> plan: SortPlan;
/// Number of digit counts: one per digit and tile.
@group(0) @binding(3) var<storage, read_write> digitCountCount: u32;
@group(0) @binding(4) var<storage, read_write> tileDispatch: array<u32, 3>;

@compute @workgroup_size(1)
fn planSort() {
  // Keys beyond the capacity would be written past the buffers' end; the host ensures that there are none.
  let count = min(keyCount, parameters.capacity);
  let tiles = (count + SORT_TILE - 1u) / SORT_TILE;
  plan = SortPlan(count, tiles);
  digitCountCount = tiles * parameters.radix;
  let size = dispatchSize(tiles, parameters.dispatchRow);
  tileDispatch = array<u32, 3>(size.x, size.y, size.z);
}
