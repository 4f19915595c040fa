// Sizes the passes of the sort by the number of keys, on the GPU. One thread.
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
  // More keys than there is room for would be written past the end; the host sees to it that there never are.
  let count = min(keyCount, parameters.capacity);
  let tiles = (count + SORT_TILE - 1u) / SORT_TILE;
  plan = SortPlan(count, tiles);
  digitCountCount = tiles * parameters.radix;
  let size = dispatchSize(tiles, parameters.dispatchRow);
  tileDispatch = array<u32, 3>(size.x, size.y, size.z);
}
