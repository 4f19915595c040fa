// Counts the splats and blobs in sight that cuts through a cloud would draw, by how far the
// thresholds of its cells are shifted. Reads links, cells and their thresholds, and the geometry of
// chunks that are not wholly in sight; adds to cutCounts, whose first n + 1 words in all copies then
// sum to the number at n codes beyond the first. One workgroup per run of chunks, one thread per
// splat, dispatched per page; with INSTANCES, per batch of instances of one page. With FRUSTUM_CULLING
// all of a chunk in sight counts, as it is drawn. With NARROW each thread takes chunks of its own.
//
// On narrow devices it runs twice in a frame, see plan-cut: from a little below the last frame's shift,
// which needs few links, and from the least shift if that was too high.
//
// Most cells are wholly in sight. In these, a blob of two nodes replaces both at its own error, which
// draws one less: no link of a splat is read, and of blobs only the own error. At the shift from which
// the cell above is drawn instead, everything that the cell draws is taken away at once.
import constants::CHUNK_SPLATS;
import constants::COUNTED_CHUNKS;
import constants::COUNT_NOTHING;
import constants::COUNT_WORKGROUP;
import constants::CUT_BINS;
import constants::CUT_COPIES;
import constants::ERROR_BOUNDLESS;
import constants::NO_CELL;
import constants::SHIFT_NONE;
@if(!GEOMETRY_F32 && !FRUSTUM_CULLING) import layout::Chunk;
import layout::ChunkLinks;
import layout::CutPlan;
import layout::LevelCell;
@if(!INSTANCES) import layout::Page;
import layout::View;
import package::lib::chunk_frustum::reachesPast;
import package::lib::dispatch::linearWorkgroup;
@if(INSTANCES) import package::lib::instances::{enterInstance, instanceIndex, page, pages};
import package::lib::level_link::{errorOf, isAlwaysDrawn, parentErrorOf};
@if(!FRUSTUM_CULLING) import package::lib::packing::GEOMETRY_VECTORS;
@if(!FRUSTUM_CULLING) import package::lib::packing::unpackSplat;

@group(0) @binding(0) var<uniform> view: View;
@if(!INSTANCES) @group(0) @binding(1) var<uniform> page: Page;
@group(0) @binding(2) var<storage, read> links: array<ChunkLinks>;
@group(0) @binding(3) var<storage, read> cells: array<LevelCell>;
@group(0) @binding(4) var<storage, read> thresholds: array<u32>;
@group(0) @binding(5) var<storage, read> cutPlan: CutPlan;
@group(0) @binding(6) var<storage, read_write> cutCounts: array<atomic<u32>, CUT_BINS * CUT_COPIES>;
@if(!FRUSTUM_CULLING) @group(0) @binding(7) var<storage, read> geometry: array<array<vec4u, GEOMETRY_VECTORS>>;
@if(!GEOMETRY_F32 && !FRUSTUM_CULLING) @group(0) @binding(8) var<storage, read> chunks: array<Chunk>;

/// Shifts below and above all possible ones.
const ALWAYS = -0x10000;
const NEVER = 0x10000;

/// Values shared by all splats of a chunk. One thread computes them, because they take longer than
/// counting a splat.
struct Head {
  /// The shift at which the threshold of the cell is 0.
  zero: i32,
  /// From this shift on, the cell above is drawn instead.
  closed: i32,
  chunk: u32,
  @if(INSTANCES) instanceIndex: u32,
  /// Whether links are to be read, and whether all of the cell is in sight.
  isCounted: bool,
  isWhole: bool,
  isBlobs: bool,
  /// Number of blobs of two nodes, which are in the first slots.
  pairs: u32,
}

/// Chunks whose links are to be read, in any order.
@if(!NARROW) var<workgroup> heads: array<Head, COUNTED_CHUNKS>;
@if(!NARROW) var<workgroup> headCount: atomic<u32>;
/// Drawn splats of these chunks, as differences from bin to bin, which wrap around below 0.
@if(!NARROW) var<workgroup> bins: array<atomic<u32>, CUT_BINS>;
@if(NARROW) var<private> bins: array<u32, CUT_BINS>;

@compute @workgroup_size(COUNT_WORKGROUP)
fn cutCount(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  if (cutPlan.next == COUNT_NOTHING) { return; }
  let index = linearWorkgroup(workgroup, view.dispatchRow);
  @if(!NARROW) countTogether(index, lane);
  @if(NARROW) countAlone(index, lane);
}

@if(!NARROW)
fn countTogether(index: u32, lane: u32) {
  let first = index * COUNTED_CHUNKS;
  if (lane < COUNTED_CHUNKS) {
    let head = headOf(first + lane);
    if (head.isCounted) { heads[atomicAdd(&headCount, 1u)] = head; }
  }
  workgroupBarrier();
  // Most nodes begin in the first bin, and additions to one word take turns.
  var inFirst = 0u;
  let count = atomicLoad(&headCount);
  for (var i = 0u; i < count; i++) { inFirst += countNode(heads[i], lane); }
  if (inFirst != 0u) { change(0u, inFirst); }
  workgroupBarrier();
  for (var bin = lane; bin < CUT_BINS; bin += COUNT_WORKGROUP) { addChange(index, bin, atomicLoad(&bins[bin])); }
}

@if(NARROW)
fn countAlone(index: u32, lane: u32) {
  for (var i = lane; i < COUNTED_CHUNKS; i += COUNT_WORKGROUP) {
    let head = headOf(index * COUNTED_CHUNKS + i);
    if (!head.isCounted) { continue; }
    var inFirst = 0u;
    let nodes = select(CHUNK_SPLATS, head.pairs, head.isWhole && head.isBlobs);
    for (var node = 0u; node < nodes; node++) { inFirst += countNode(head, node); }
    change(0u, inFirst);
  }
  for (var bin = 0u; bin < CUT_BINS; bin++) { addChange(index, bin, bins[bin]); }
}

/// Changes the number from one bin on.
fn change(bin: u32, by: u32) {
  @if(!NARROW) atomicAdd(&bins[bin], by);
  @if(NARROW) bins[bin] += by;
}

fn addChange(index: u32, bin: u32, by: u32) {
  if (by != 0u) { atomicAdd(&cutCounts[index % CUT_COPIES * CUT_BINS + bin], by); }
}

/// Finds the facts that a chunk's splats share; counts all splats of a cell in sight at once.
/// Counts nothing behind the last chunk, and if the cell above is drawn instead at any shift.
fn headOf(place: u32) -> Head {
  var head: Head;
  @if(!INSTANCES) let chunk = place;
  @if(INSTANCES) enterInstance(pages[0].chunkStart + place);
  @if(INSTANCES) let chunk = pages[0].chunkStart + place - page.chunkStart;
  // Of a streamed scene, many places hold no splats.
  if (chunk >= page.chunkCount || links[chunk].largestParentError == 0u) { return head; }
  let cell = cells[links[chunk].cell];
  head.chunk = chunk;
  @if(INSTANCES) head.instanceIndex = instanceIndex;
  head.zero = SHIFT_NONE - i32(thresholds[page.cellStart + links[chunk].cell]);
  head.closed = NEVER;
  if (cell.parent != NO_CELL) {
    head.closed = shiftTo(links[chunk].cellError, SHIFT_NONE - i32(thresholds[page.cellStart + cell.parent]));
  }
  let end = binOf(head.closed);
  if (end == 0u) { return head; }
  head.isBlobs = links[chunk].count > 0u;
  head.pairs = links[chunk].pairs;
  let center = 0.5 * (cell.minPosition + cell.maxPosition);
  let halfExtent = 0.5 * (cell.maxPosition - cell.minPosition);
  head.isWhole = isWithin(center, halfExtent);
  if (!head.isWhole) {
    let last = min(head.closed, shiftTo(links[chunk].largestParentError, head.zero));
    head.isCounted = binOf(last) > 0u && reachesIn(center, halfExtent, links[chunk].largestScale);
  } else if (links[chunk].leastError > 0u) {
    head.isCounted = binOf(shiftTo(links[chunk].leastError, head.zero)) < min(end, CUT_BINS);
    if (head.isCounted && head.isBlobs && end < CUT_BINS) { change(end, head.pairs); }
  } else {
    let count = min(CHUNK_SPLATS, page.splatCount - chunk * CHUNK_SPLATS) - links[chunk].uncounted;
    change(0u, count);
    if (end < CUT_BINS) { change(end, 0u - count); }
  }
  return head;
}

/// Counts one splat or blob; returns the number to add to the first bin.
fn countNode(head: Head, lane: u32) -> u32 {
  @if(INSTANCES) instanceIndex = head.instanceIndex;
  let link = links[head.chunk].links[lane];
  // The first blobs of a cell that is wholly in sight: `headOf` has counted where all of these end.
  let isPair = head.isWhole && head.isBlobs;
  if (link == 0u || isAlwaysDrawn(link) || (isPair && lane >= head.pairs)) { return 0u; }
  var end = binOf(head.closed);
  if (!head.isWhole) { end = min(end, binOf(shiftTo(parentErrorOf(link), head.zero))); }
  let start = min(binOf(shiftTo(errorOf(link), head.zero)), end);
  if (start >= CUT_BINS || (start == end && !isPair)) { return 0u; }
  @if(!FRUSTUM_CULLING) if (!head.isWhole && !isInSight(head.chunk, lane)) { return 0u; }
  let by = select(1u, 0xffffffffu, isPair);
  if (start > 0u) { change(start, by); }
  if (!isPair && end < CUT_BINS) { change(end, 0u - by); }
  return select(0u, by, start == 0u);
}

/// The shift that takes a threshold, 0 at the shift `zero`, to `error`.
fn shiftTo(error: u32, zero: i32) -> i32 {
  if (error == 0u) { return ALWAYS; }
  if (error == ERROR_BOUNDLESS) { return NEVER; }
  return zero + i32(error);
}

/// The first bin whose shift is `shift` or more.
fn binOf(shift: i32) -> u32 {
  return u32(max(shift - i32(max(cutPlan.base, cutPlan.leastShift)), 0));
}

@if(!INSTANCES) fn sideOf(i: u32) -> vec4f { return page.frustum[i]; }
@if(INSTANCES) fn sideOf(i: u32) -> vec4f { return pages[instanceIndex].frustum[i]; }
@if(!INSTANCES) fn reachAcross(i: u32) -> f32 { return page.frustumReach[i].x; }
@if(INSTANCES) fn reachAcross(i: u32) -> f32 { return pages[instanceIndex].frustumReach[i].x; }

/// Whether splats in a box, none larger than about `maxScale`, can reach into the image.
fn reachesIn(center: vec3f, halfExtent: vec3f, maxScale: f32) -> bool {
  for (var i = 0u; i < 6u; i++) {
    let reach = reachAcross(i) * 1.001 * maxScale;
    if (!reachesPast(sideOf(i), reach, center, halfExtent)) { return false; }
  }
  return true;
}

/// Whether all centres in a box are in the frustum.
fn isWithin(center: vec3f, halfExtent: vec3f) -> bool {
  for (var i = 0u; i < 6u; i++) {
    let side = sideOf(i);
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
