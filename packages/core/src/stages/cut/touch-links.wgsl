// Refines cuts around splats that are to be drawn one by one. Reads a bit per splat and bounds of
// chunks; changes copies of the links: no blob above such a splat is drawn at any threshold, and
// every node whose parent is one of these blobs is drawn from its own error on. Hidden splats are
// never drawn. One workgroup per cell, one thread per splat and blob, from level to level. With
// UPPER the splats are roots of the level below.
import constants::CELL_ROOTS;
import constants::CHUNK_SPLATS;
import constants::ERROR_BOUNDLESS;
import constants::MASK_WORDS;
@if(!UPPER) import layout::Chunk;
import layout::ChunkLinks;
import layout::MergeParameters;
import package::lib::dispatch::linearWorkgroup;
import package::lib::level_link::{errorOf, isAlwaysDrawn, linkOf, parentErrorOf, parentSlotOf};
import package::lib::merged_cell::{chunksOf, leafAbove};

@group(0) @binding(0) var<uniform> parameters: MergeParameters;
/// Of all levels above the chunks': leaves of cell u of these are chunk 2u, and its blobs 2u + 1.
@group(0) @binding(1) var<storage, read_write> upperLinks: array<ChunkLinks>;
@if(!UPPER) @group(0) @binding(2) var<storage, read_write> splatLinks: array<ChunkLinks>;
@if(!UPPER) @group(0) @binding(3) var<storage, read_write> blobLinks: array<ChunkLinks>;
@if(!UPPER) @group(0) @binding(4) var<storage, read> editedBits: array<u32>;
@if(!UPPER) @group(0) @binding(5) var<storage, read> hiddenBits: array<u32>;
/// The masks of all selections, one after the other.
@if(!UPPER) @group(0) @binding(6) var<storage, read> selectedBits: array<u32>;
@if(!UPPER) @group(0) @binding(7) var<storage, read> chunks: array<Chunk>;

/// A bit per blob: whether it is above a splat that is drawn by itself.
var<workgroup> above: array<atomic<u32>, MASK_WORDS>;
/// Complements of the least errors of splats and blobs.
var<workgroup> leastErrors: array<atomic<u32>, 2>;
@if(!UPPER) var<workgroup> uncounted: atomic<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn touchLinks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let cell = parameters.firstCell + linearWorkgroup(workgroup, parameters.dispatchRow);
  if (cell >= parameters.endCell) { return; }
  let chunk = chunksOf(parameters, cell);
  let splatChunk = chunk.x;
  let blobChunk = chunk.y;
  @if(!UPPER) let ofSplats = &splatLinks[splatChunk];
  @if(UPPER) let ofSplats = &upperLinks[splatChunk];
  @if(!UPPER) let ofBlobs = &blobLinks[blobChunk];
  @if(UPPER) let ofBlobs = &upperLinks[blobChunk];

  let splat = (*ofSplats).links[lane];
  let blob = (*ofBlobs).links[lane];
  var isHidden = false;
  if (splat != 0u) {
    @if(!UPPER) isHidden = bitOf(hiddenBits[splatChunk * MASK_WORDS + lane / 32u], lane);
    @if(!UPPER) let isTouched = isTouchedSplat(splatChunk, lane);
    // The level below has given the roots of touched cells this error.
    @if(UPPER) let isTouched = errorOf(splat) == ERROR_BOUNDLESS;
    if (isTouched) { markAbove(blobChunk, parentSlotOf(splat)); }
  }
  storageBarrier();
  workgroupBarrier();

  if (splat != 0u) {
    let link = refined(splat, isHidden, 0u);
    (*ofSplats).links[lane] = link;
    @if(!UPPER) if (isHidden || isAlwaysDrawn(link)) { atomicAdd(&uncounted, 1u); }
  }
  if (blob != 0u) { (*ofBlobs).links[lane] = refined(blob, isAbove(lane), 1u); }
  workgroupBarrier();

  var isCellTouched = false;
  for (var word = 0u; word < MASK_WORDS; word++) { isCellTouched = isCellTouched || atomicLoad(&above[word]) != 0u; }
  if (isCellTouched && parameters.hasNextLevel == 1u && lane < CELL_ROOTS) {
    // This cell is drawn at any threshold, so its roots are never drawn as leaves of the cell above.
    let leaf = leafAbove(parameters, cell, lane);
    let root = upperLinks[leaf.x].links[leaf.y];
    if (root != 0u) { upperLinks[leaf.x].links[leaf.y] = root | ERROR_BOUNDLESS; }
  }
  if (lane == 0u) {
    (*ofSplats).leastError = ~atomicLoad(&leastErrors[0]);
    (*ofBlobs).leastError = ~atomicLoad(&leastErrors[1]);
    @if(!UPPER) (*ofSplats).uncounted = atomicLoad(&uncounted);
  }
  if (lane == 0u && isCellTouched) {
    (*ofSplats).cellError = ERROR_BOUNDLESS;
    (*ofBlobs).cellError = ERROR_BOUNDLESS;
    (*ofSplats).largestParentError = ERROR_BOUNDLESS;
    // Edited splats may be larger.
    @if(!UPPER) let maxScale = exp(chunks[splatChunk].minLogScale + 65535.0 * chunks[splatChunk].logScaleStep);
    @if(!UPPER) (*ofSplats).largestScale = max((*ofSplats).largestScale, maxScale);
  }
}

@if(!UPPER)
fn isTouchedSplat(chunk: u32, lane: u32) -> bool {
  let stride = (parameters.splatCount + 31u) / 32u;
  let word = chunk * MASK_WORDS + lane / 32u;
  var bits = editedBits[word];
  let selections = arrayLength(&selectedBits) / stride;
  for (var i = 0u; i < selections; i++) { bits |= selectedBits[i * stride + word]; }
  return bitOf(bits, lane);
}

fn bitOf(bits: u32, lane: u32) -> bool {
  return extractBits(bits, lane % 32u, 1u) == 1u;
}

fn isAbove(slot: u32) -> bool {
  return bitOf(atomicLoad(&above[slot / 32u]), slot);
}

/// Marks a blob and all blobs above it in its cell.
fn markAbove(blobChunk: u32, first: u32) {
  var slot = first;
  for (var step = 0u; step < CHUNK_SPLATS; step++) {
    let bit = 1u << (slot % 32u);
    // The thread that has marked this blob marks the blobs above it, too.
    if ((atomicOr(&above[slot / 32u], bit) & bit) != 0u) { break; }
    @if(!UPPER) let link = blobLinks[blobChunk].links[slot];
    @if(UPPER) let link = upperLinks[blobChunk].links[slot];
    if (parentErrorOf(link) == ERROR_BOUNDLESS) { break; }
    slot = parentSlotOf(link);
  }
}

/// The link of a splat (kind 0) or blob (kind 1), whose own error counts among the errors of its
/// kind.
fn refined(link: u32, isGone: bool, kind: u32) -> u32 {
  let error = select(errorOf(link), ERROR_BOUNDLESS, isGone);
  let parentError = select(parentErrorOf(link), ERROR_BOUNDLESS, isAbove(parentSlotOf(link)));
  atomicMax(&leastErrors[kind], ~error);
  return linkOf(error, parentError, parentSlotOf(link));
}
