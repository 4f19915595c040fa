// Decides which splats of the visible chunks are drawn. Reads the page's plan, its visible chunks,
// and its geometry with the ranges of packed log scales; writes a bit per splat, a count per chunk
// and the range of depths. One workgroup per visible chunk, one thread per splat, dispatched per
// page; with INSTANCES, per batch of instances of one page. Skips the covariance if opacity or depth
// alone decides. With NARROW one thread per visible chunk, which waits for no other, and at most one
// workgroup.
import constants::CHUNK_SPLATS;
import constants::CULL_WORKGROUP;
import constants::MASK_WORDS;
@if(OPACITY_EFFECTS && !FRUSTUM_CULLING) import effects::changeOpacity;
@if(SCREEN_EFFECTS) import effects::changeScreen;
@if(SPLAT_EFFECTS) import effects::changeSplat;
@if(!GEOMETRY_F32) import layout::Chunk;
import layout::View;
@if(!INSTANCES) import layout::Page;
import layout::PagePlan;
import package::lib::depth_key::{orderedBits, sortDepth};
@if(DILATED) import package::lib::dilated_blob::{BlobPlace, dilatedBlob};
import package::lib::dispatch::linearWorkgroup;
@if(INSTANCES) import package::lib::instances::{enterInstance, page, pages};
import package::lib::packing::GEOMETRY_VECTORS;
import package::lib::packing::Splat;
import package::lib::packing::unpackSplat;
@if(!FRUSTUM_CULLING) import package::lib::visible_ellipse::extentPx;
import package::lib::visible_ellipse::isInDepthRange;
@if(!FRUSTUM_CULLING) import package::lib::visible_ellipse::reachInAxes;
@if(FRUSTUM_CULLING) import package::lib::visible_ellipse::screenCenter;
@if(!FRUSTUM_CULLING) import package::lib::visible_ellipse::screenSplat;

@group(0) @binding(0) var<uniform> view: View;
@if(!INSTANCES) @group(0) @binding(1) var<uniform> page: Page;
@group(0) @binding(2) var<storage, read> pagePlans: array<PagePlan>;
@group(0) @binding(3) var<storage, read> visibleChunks: array<u32>;
@group(0) @binding(4) var<storage, read> geometry: array<array<vec4u, GEOMETRY_VECTORS>>;
/// With LEVELS, first the bits of the cut.
@group(0) @binding(5) var<storage, read_write> visibilityMasks: array<u32>;
@group(0) @binding(6) var<storage, read_write> splatOffsets: array<u32>;
/// Ordered bits of the farthest and, inverted, of the nearest depth (`sortDepth`): both grow from
/// 0. Atomic, but with integers, so the result does not depend on the order.
@group(0) @binding(7) var<storage, read_write> depthRange: array<atomic<u32>, 2>;
@if(!GEOMETRY_F32) @group(0) @binding(8) var<storage, read> chunks: array<Chunk>;

/// No number has these ordered bits.
const NOT_DRAWN = 0u;

@if(!NARROW) var<workgroup> mask: array<atomic<u32>, MASK_WORDS>;
@if(!NARROW) var<workgroup> farthest: atomic<u32>;
@if(!NARROW) var<workgroup> nearestInverted: atomic<u32>;

@if(!NARROW)
@compute @workgroup_size(CULL_WORKGROUP)
fn cullSplats(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  @if(INSTANCES) page.index = pages[0].index;
  let plan = pagePlans[page.index];
  let slotInPage = linearWorkgroup(workgroup, view.dispatchRow);
  let slot = plan.slotStart + slotInPage;
  let isSlot = slotInPage < plan.slotCount;
  var splatIndex = 0xffffffffu;
  @if(INSTANCES) if (isSlot) { enterInstance(visibleChunks[slot]); }
  if (isSlot) { splatIndex = (visibleChunks[slot] - page.chunkStart) * CHUNK_SPLATS + lane; }

  var isCandidate = splatIndex < page.splatCount;
  // Most splats of a visible chunk are not in the cut, which cut-splats has marked: skip them before reading their
  // geometry.
  @if(LEVELS) isCandidate &= extractBits(visibilityMasks[slot * MASK_WORDS + lane / 32u], lane % 32u, 1u) == 1u;
  if (isCandidate) {
    let bits = depthBits(splatIndex);
    if (bits != NOT_DRAWN) {
      atomicOr(&mask[lane / 32u], 1u << (lane % 32u));
      atomicMax(&farthest, bits);
      atomicMax(&nearestInverted, ~bits);
    }
  }
  workgroupBarrier();
  @if(LEVELS) storageBarrier();

  if (isSlot && lane < MASK_WORDS) { visibilityMasks[slot * MASK_WORDS + lane] = atomicLoad(&mask[lane]); }
  if (isSlot && lane == 0u) {
    var count = 0u;
    for (var word = 0u; word < MASK_WORDS; word++) { count += countOneBits(atomicLoad(&mask[word])); }
    splatOffsets[slot] = count;
    if (count > 0u) {
      atomicMax(&depthRange[0], atomicLoad(&farthest));
      atomicMax(&depthRange[1], atomicLoad(&nearestInverted));
    }
  }
}

@if(NARROW)
@compute @workgroup_size(CULL_WORKGROUP)
fn cullSplats(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  @if(INSTANCES) page.index = pages[0].index;
  let plan = pagePlans[page.index];
  let slotInPage = linearWorkgroup(workgroup, view.dispatchRow) * CULL_WORKGROUP + lane;
  if (slotInPage >= plan.slotCount) { return; }
  let slot = plan.slotStart + slotInPage;
  @if(INSTANCES) enterInstance(visibleChunks[slot]);
  let firstSplat = (visibleChunks[slot] - page.chunkStart) * CHUNK_SPLATS;
  var count = 0u;
  var farthest = 0u;
  var nearestInverted = 0u;
  for (var word = 0u; word < MASK_WORDS; word++) {
    let first = firstSplat + 32u * word;
    @if(!LEVELS) var candidates = 0xffffffffu;
    @if(LEVELS) var candidates = visibilityMasks[slot * MASK_WORDS + word];
    var drawn = 0u;
    let candidateCount = countOneBits(candidates);
    for (var candidate = 0u; candidate < candidateCount; candidate++) {
      let bit = firstTrailingBit(candidates);
      candidates &= candidates - 1u;
      if (first + bit >= page.splatCount) { break; }
      let bits = depthBits(first + bit);
      if (bits == NOT_DRAWN) { continue; }
      drawn |= 1u << bit;
      farthest = max(farthest, bits);
      nearestInverted = max(nearestInverted, ~bits);
    }
    visibilityMasks[slot * MASK_WORDS + word] = drawn;
    count += countOneBits(drawn);
  }
  splatOffsets[slot] = count;
  if (count > 0u) {
    atomicMax(&depthRange[0], farthest);
    atomicMax(&depthRange[1], nearestInverted);
  }
}

/// Ordered bits of the depth of a splat, if it is drawn.
fn depthBits(index: u32) -> u32 {
  @if(!GEOMETRY_F32) let chunk = &chunks[index / CHUNK_SPLATS];
  @if(!GEOMETRY_F32) let logScales = vec2f((*chunk).minLogScale, (*chunk).logScaleStep);
  @if(!GEOMETRY_F32) let stored = unpackSplat(geometry[index], logScales);
  @if(GEOMETRY_F32 && !DILATED) let stored = unpackSplat(geometry[index]);
  @if(DILATED) let words = geometry[index];
  @if(DILATED) let place = BlobPlace(page.linear, page.translation, page.dilationPx2);
  @if(DILATED) let stored = dilatedBlob(view, place, words, unpackSplat(words));
  @if(!SPLAT_EFFECTS) let splat = stored;
  @if(SPLAT_EFFECTS) let splat = changeSplat(stored, index);
  let centerView = page.linear * splat.position + page.translation;
  if (splat.opacity < view.alphaCutoff || !isInDepthRange(view, -centerView.z)) { return NOT_DRAWN; }
  if (!isDrawn(splat, centerView)) { return NOT_DRAWN; }
  return orderedBits(sortDepth(centerView, view.near));
}

/// Whether any part of the splat's box is in the image.
@if(!FRUSTUM_CULLING)
fn isDrawn(splat: Splat, centerView: vec3f) -> bool {
  let onScreen = screenSplat(view, page.linear, page.dilationPx2, splat, centerView);
  @if(!OPACITY_EFFECTS) let opacity = splat.opacity;
  @if(OPACITY_EFFECTS) let opacity = changeOpacity(splat.opacity, onScreen, page.dilationPx2);
  @if(OPACITY_EFFECTS) if (opacity < view.alphaCutoff) { return false; }
  @if(!SCREEN_EFFECTS) let extent = extentPx(onScreen.covariance, reachInAxes(opacity, view.alphaCutoff));
  @if(SCREEN_EFFECTS) let covariance = changeScreen(onScreen).covariance;
  @if(SCREEN_EFFECTS) let extent = extentPx(covariance, reachInAxes(opacity, view.alphaCutoff));
  return all(onScreen.centerPx + extent > vec2f(0.0)) && all(onScreen.centerPx - extent < view.sizePx);
}

/// Farthest centre that is drawn. Splats are not tested against the image here, but a centre beyond
/// float32's range cannot be drawn.
@if(FRUSTUM_CULLING) const FARTHEST_CENTER_PX = 1e18;

@if(FRUSTUM_CULLING)
fn isDrawn(splat: Splat, centerView: vec3f) -> bool {
  return all(abs(screenCenter(view, centerView)) < vec2f(FARTHEST_CENTER_PX));
}
