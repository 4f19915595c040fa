// Counts the splats and blobs in sight that cuts through a cloud would draw, by how far the
// thresholds of its cells are shifted. Reads links, cells and their thresholds, and the geometry of
// chunks that are not wholly in sight; adds to cutCounts, whose first n + 1 words in all copies then
// sum to the number at n steps beyond the plan's base. One workgroup per run of chunks, one thread
// per splat, dispatched per page. With FRUSTUM_CULLING all of a chunk in sight counts, as it is drawn.
import constants::CHUNK_SPLATS;
import constants::COUNTED_CHUNKS;
import constants::CUT_BINS;
import constants::CUT_COPIES;
import constants::ERROR_BOUNDLESS;
import constants::NO_CELL;
import constants::SHIFT_NONE;
@if(!GEOMETRY_F32 && !FRUSTUM_CULLING) import layout::Chunk;
import layout::ChunkLinks;
import layout::CutPlan;
import layout::LevelCell;
import layout::Page;
import layout::View;
import package::lib::chunk_frustum::reachesPast;
import package::lib::dispatch::linearWorkgroup;
import package::lib::level_link::{errorOf, parentErrorOf};
@if(!FRUSTUM_CULLING) import package::lib::packing::GEOMETRY_VECTORS;
@if(!FRUSTUM_CULLING) import package::lib::packing::unpackSplat;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> page: Page;
@group(0) @binding(2) var<storage, read> links: array<ChunkLinks>;
@group(0) @binding(3) var<storage, read> cells: array<LevelCell>;
@group(0) @binding(4) var<storage, read> thresholds: array<u32>;
@group(0) @binding(5) var<storage, read> cutPlan: CutPlan;
@group(0) @binding(6) var<storage, read_write> cutCounts: array<atomic<u32>, CUT_BINS * CUT_COPIES>;
@if(!FRUSTUM_CULLING) @group(0) @binding(7) var<storage, read> geometry: array<array<vec4u, GEOMETRY_VECTORS>>;
@if(!GEOMETRY_F32 && !FRUSTUM_CULLING) @group(0) @binding(8) var<storage, read> chunks: array<Chunk>;

/// Shifts before and beyond all that are possible.
const ALWAYS = -0x10000;
const NEVER = 0x10000;

/// What all splats of a chunk have in common: found by one thread, because it takes longer than to
/// count a splat.
struct Head {
  /// The shift at which the threshold of the cell is 0.
  zero: i32,
  /// From this shift on, the cell above is drawn instead.
  closed: i32,
  /// Whether something counts; and whether each splat is to be tested against the frustum.
  isCounted: u32,
  isTested: u32,
}

var<workgroup> heads: array<Head, COUNTED_CHUNKS>;
/// Of these chunks: changes of the number from bin to bin, which wrap around below 0.
var<workgroup> bins: array<atomic<u32>, CUT_BINS>;

@compute @workgroup_size(CHUNK_SPLATS)
fn cutCount(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = linearWorkgroup(workgroup, view.dispatchRow);
  let first = index * COUNTED_CHUNKS;
  if (lane < COUNTED_CHUNKS && first + lane < page.chunkCount) { heads[lane] = headOf(first + lane); }
  workgroupBarrier();
  // Most splats begin there, and additions to one word take turns.
  var inFirst = 0u;
  for (var i = 0u; i < COUNTED_CHUNKS; i++) {
    if (heads[i].isCounted != 0u) { inFirst += countSplat(heads[i], first + i, lane); }
  }
  if (inFirst > 0u) { atomicAdd(&bins[0], inFirst); }
  workgroupBarrier();
  if (lane < CUT_BINS) {
    let change = atomicLoad(&bins[lane]);
    if (change != 0u) { atomicAdd(&cutCounts[index % CUT_COPIES * CUT_BINS + lane], change); }
  }
}

fn headOf(chunk: u32) -> Head {
  let cell = cells[links[chunk].cell];
  let zero = SHIFT_NONE - i32(thresholds[links[chunk].cell]);
  var closed = NEVER;
  if (cell.parent != NO_CELL) {
    closed = SHIFT_NONE + i32(links[chunk].cellError) - i32(thresholds[cell.parent]);
  }
  let last = min(closed, shiftTo(links[chunk].largestParentError, zero));
  let center = 0.5 * (cell.minPosition + cell.maxPosition);
  let halfExtent = 0.5 * (cell.maxPosition - cell.minPosition);
  let isCounted = last > i32(cutPlan.base) && reachesIn(center, halfExtent, links[chunk].largestScale);
  @if(!FRUSTUM_CULLING) let isTested = !isWithin(center, halfExtent);
  @if(FRUSTUM_CULLING) let isTested = false;
  return Head(zero, closed, u32(isCounted), u32(isTested));
}

/// Counts one splat or blob; returns 1 for the first bin, to which nothing is added.
fn countSplat(head: Head, chunk: u32, lane: u32) -> u32 {
  let link = links[chunk].links[lane];
  if (link == 0u) { return 0u; }
  let start = binOf(shiftTo(errorOf(link), head.zero));
  let end = binOf(min(head.closed, shiftTo(parentErrorOf(link), head.zero)));
  if (start >= end || start >= CUT_BINS) { return 0u; }
  @if(!FRUSTUM_CULLING) if (head.isTested != 0u && !isInSight(chunk, lane)) { return 0u; }
  if (start > 0u) { atomicAdd(&bins[start], 1u); }
  if (end < CUT_BINS) { atomicSub(&bins[end], 1u); }
  return select(0u, 1u, start == 0u);
}

/// The shift that takes a threshold, 0 at the shift `zero`, to `error`.
fn shiftTo(error: u32, zero: i32) -> i32 {
  if (error == 0u) { return ALWAYS; }
  if (error == ERROR_BOUNDLESS) { return NEVER; }
  return zero + i32(error);
}

/// The first bin whose shift is `shift` or more.
fn binOf(shift: i32) -> u32 {
  let beyond = u32(max(shift - i32(cutPlan.base), 0));
  return (beyond + cutPlan.step - 1u) / cutPlan.step;
}

/// Whether splats in a box, none larger than about `maxScale`, can reach into the image.
fn reachesIn(center: vec3f, halfExtent: vec3f, maxScale: f32) -> bool {
  for (var i = 0u; i < 6u; i++) {
    let reach = page.frustumReach[i].x * 1.001 * maxScale;
    if (!reachesPast(page.frustum[i], reach, center, halfExtent)) { return false; }
  }
  return true;
}

/// Whether all centres in a box are in the frustum.
@if(!FRUSTUM_CULLING)
fn isWithin(center: vec3f, halfExtent: vec3f) -> bool {
  for (var i = 0u; i < 6u; i++) {
    let side = page.frustum[i];
    if (dot(side.xyz, center) + side.w < dot(abs(side.xyz), halfExtent)) { return false; }
  }
  return true;
}

@if(!FRUSTUM_CULLING)
fn isInSight(chunk: u32, lane: u32) -> bool {
  let words = geometry[chunk * CHUNK_SPLATS + lane];
  @if(GEOMETRY_F32) let splat = unpackSplat(words);
  @if(!GEOMETRY_F32) let splat = unpackSplat(words, vec2f(chunks[chunk].minLogScale, chunks[chunk].logScaleStep));
  return reachesIn(splat.position, vec3f(0.0), max(splat.scale.x, max(splat.scale.y, splat.scale.z)));
}
