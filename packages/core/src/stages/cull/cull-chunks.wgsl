// Decides which chunks of splats can reach into the image. Reads the chunks' bounds; writes 1 or 0
// per chunk to chunkOffsets, which a scan then turns into places. One thread per chunk, dispatched
// per page; with INSTANCES, per batch of instances of one page. With LEVELS it tests the bounds of
// the chunk's cell, and leaves out a chunk that the cut does not go through: a cell is drawn if its
// parent's leaves would show, and a chunk of it if one of its links is met.
import constants::CHUNK_WORKGROUP;
import layout::View;
@if(!INSTANCES) import layout::Page;
@if(!LEVELS) import layout::Chunk;
@if(LEVELS) import layout::ChunkLinks;
@if(LEVELS) import layout::LevelCell;
@if(LEVELS) import constants::NO_CELL;
@if(BOUNDS_EFFECTS && !LEVELS) import effects::changeBounds;
@if(BOUNDS_EFFECTS && !LEVELS) import package::lib::chunk_frustum::ChunkBounds;
import package::lib::chunk_frustum::reachesPast;
import package::lib::dispatch::linearWorkgroup;
@if(INSTANCES) import package::lib::instances::{enterInstance, instanceIndex, page, pages};

@group(0) @binding(0) var<uniform> view: View;
@if(!INSTANCES) @group(0) @binding(1) var<uniform> page: Page;
@if(!LEVELS) @group(0) @binding(2) var<storage, read> chunks: array<Chunk>;
@group(0) @binding(3) var<storage, read_write> chunkOffsets: array<u32>;
@if(LEVELS) @group(0) @binding(4) var<storage, read> links: array<ChunkLinks>;
@if(LEVELS) @group(0) @binding(5) var<storage, read> cells: array<LevelCell>;
@if(LEVELS) @group(0) @binding(6) var<storage, read> thresholds: array<u32>;

@compute @workgroup_size(CHUNK_WORKGROUP)
fn cullChunks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  @if(!INSTANCES) let index = linearWorkgroup(workgroup, view.dispatchRow) * CHUNK_WORKGROUP + lane;
  @if(INSTANCES) let chunk = pages[0].chunkStart + linearWorkgroup(workgroup, view.dispatchRow) * CHUNK_WORKGROUP + lane;
  @if(INSTANCES) enterInstance(chunk);
  @if(INSTANCES) let index = chunk - page.chunkStart;
  if (index >= page.chunkCount) { return; }
  @if(!LEVELS) let isVisible = isInFrustum(index);
  @if(LEVELS) let isVisible = isInCut(index) && isInFrustum(index);
  chunkOffsets[page.chunkStart + index] = select(0u, 1u, isVisible);
}

@if(LEVELS)
fn isInCut(index: u32) -> bool {
  let limit = thresholds[page.cellStart + links[index].cell];
  let parent = cells[links[index].cell].parent;
  let above = page.cellStart + min(parent, arrayLength(&cells) - 1u);
  let isDrawn = parent == NO_CELL || thresholds[above] < links[index].cellError;
  return isDrawn && links[index].leastError <= limit && limit < links[index].largestParentError;
}

@if(!LEVELS)
fn isInFrustum(index: u32) -> bool {
  let chunk = chunks[index];
  // With room for rounding.
  let maxScale = 1.001 * exp(chunk.minLogScale + 65535.0 * chunk.logScaleStep);
  @if(!BOUNDS_EFFECTS) return reachesIn(chunk.minPosition, chunk.maxPosition, maxScale);
  @if(BOUNDS_EFFECTS) {
    let bounds = changeBounds(ChunkBounds(chunk.minPosition, chunk.maxPosition), index);
    if (bounds.minPosition.x > bounds.maxPosition.x) { return false; }
    return reachesIn(bounds.minPosition, bounds.maxPosition, maxScale);
  }
}

@if(LEVELS)
fn isInFrustum(index: u32) -> bool {
  let cell = cells[links[index].cell];
  return reachesIn(cell.minPosition, cell.maxPosition, 1.001 * links[index].largestScale);
}

/// Whether splats in a box, none larger than `maxScale`, can reach into the image.
fn reachesIn(minPosition: vec3f, maxPosition: vec3f, maxScale: f32) -> bool {
  let center = 0.5 * (minPosition + maxPosition);
  let halfExtent = 0.5 * (maxPosition - minPosition);
  for (var i = 0u; i < 6u; i++) {
    @if(!INSTANCES) if (!reachesPast(page.frustum[i], page.frustumReach[i].x * maxScale, center, halfExtent)) { return false; }
    @if(INSTANCES) let reach = pages[instanceIndex].frustumReach[i].x * maxScale;
    @if(INSTANCES) if (!reachesPast(pages[instanceIndex].frustum[i], reach, center, halfExtent)) { return false; }
  }
  return true;
}
