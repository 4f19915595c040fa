// Finds the threshold of each cell of a cloud: errors up to it are not seen from the camera. Reads
// bounds of cells; writes thresholds, one instance after another. One thread per cell and instance,
// dispatched per batch of instances. A cell lies within its parent, each step here rounds larger
// numbers to larger or equal ones, and all cells take the same steps, with the same least threshold:
// a parent's threshold is never more than its children's. So each cell decides by itself and its
// parent whether it is drawn, and nothing has to be traversed. With SHIFTED a budget moves all thresholds.
import constants::BATCH_INSTANCES;
import constants::CHUNK_WORKGROUP;
import layout::CutParameters;
@if(SHIFTED) import layout::CutPlan;
import layout::LevelCell;
import package::lib::dispatch::linearWorkgroup;
import package::lib::level_link::threshold;
@if(SHIFTED) import package::lib::level_link::shifted;

@group(0) @binding(0) var<uniform> cuts: array<CutParameters, BATCH_INSTANCES>;
@group(0) @binding(1) var<storage, read> cells: array<LevelCell>;
@group(0) @binding(2) var<storage, read_write> thresholds: array<u32>;
@if(SHIFTED) @group(0) @binding(3) var<storage, read> cutPlan: CutPlan;

/// Squares of longer distances leave float32's range.
const FARTHEST = 1e18;

@compute @workgroup_size(CHUNK_WORKGROUP)
fn cutCells(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = linearWorkgroup(workgroup, cuts[0].dispatchRow) * CHUNK_WORKGROUP + lane;
  if (index >= arrayLength(&thresholds)) { return; }
  let cellCount = cuts[0].cellCount;
  let cell = cells[index % cellCount];
  let cut = cuts[index / cellCount];
  let before = cell.minPosition - cut.camera;
  let behind = cut.camera - cell.maxPosition;
  let apart = clamp(max(before, behind) - cut.margin, vec3f(0.0), vec3f(FARTHEST));
  let distance2 = dot(apart, apart);
  let limit = threshold(max(distance2 * cut.squaredPerDistance, cut.leastSquared));
  @if(!SHIFTED) thresholds[index] = limit;
  @if(SHIFTED) thresholds[index] = shifted(limit, cutPlan.shift);
}
