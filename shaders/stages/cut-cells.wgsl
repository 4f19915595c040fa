// Finds the threshold of each cell of a cloud: errors up to it are not seen, from where the camera
// is. Reads bounds of cells; writes thresholds. One thread per cell. A cell lies within its parent,
// each step here rounds larger numbers to larger or equal ones, and all cells take the same steps,
// with the same least threshold: a parent's is never more than its children's. So where a cell is
// drawn, its parent's other cells know, and nothing has to be traversed. With SHIFTED a budget moves
// all thresholds.
import constants::CHUNK_WORKGROUP;
import layout::CutParameters;
@if(SHIFTED) import layout::CutPlan;
import layout::LevelCell;
import package::lib::dispatch::linearWorkgroup;
import package::lib::level_link::threshold;
@if(SHIFTED) import package::lib::level_link::shifted;

@group(0) @binding(0) var<uniform> parameters: CutParameters;
@group(0) @binding(1) var<storage, read> cells: array<LevelCell>;
@group(0) @binding(2) var<storage, read_write> thresholds: array<u32>;
@if(SHIFTED) @group(0) @binding(3) var<storage, read> cutPlan: CutPlan;

/// Squares of longer distances leave float32's range.
const FARTHEST = 1e18;

@compute @workgroup_size(CHUNK_WORKGROUP)
fn cutCells(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_WORKGROUP + lane;
  if (index >= parameters.cellCount) { return; }
  let before = cells[index].minPosition - parameters.camera;
  let behind = parameters.camera - cells[index].maxPosition;
  let apart = clamp(max(before, behind) - parameters.margin, vec3f(0.0), vec3f(FARTHEST));
  let distance2 = dot(apart, apart);
  let limit = threshold(max(distance2 * parameters.squaredPerDistance, parameters.leastSquared));
  @if(!SHIFTED) thresholds[index] = limit;
  @if(SHIFTED) thresholds[index] = shifted(limit, cutPlan.shift);
}
