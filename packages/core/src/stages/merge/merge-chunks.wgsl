// Merges the splats of each cell, two by two, until sixteen blobs or fewer stand for all of them,
// and makes these the leaves of the cell above. Reads bounds of cells and splats; writes blobs,
// links, and the leaves of the next level. One workgroup per cell, one thread per splat. With UPPER
// the splats are roots of the level below, in the buffer that blobs go to.
//
// In each round every node finds the neighbour in storage order that is cheapest to merge with, and
// pairs that find each other merge (parallel locally-ordered clustering, Meister and Bittner 2018,
// with Ward's cost). A node stays with its thread; the first thread of a pair takes the blob. The cost
// of a pair is the same from both sides, and of equal costs the first place counts. So each round has
// a pair, and the result is the same every time.
import constants::CELL_ROOTS;
import constants::CHUNK_SPLATS;
import constants::ERROR_BOUNDLESS;
import constants::MASK_WORDS;
import constants::MERGED_RADIUS;
import constants::MOST_OPACITY;
@if(!GEOMETRY_F32) import layout::Chunk;
import layout::ChunkLinks;
import layout::LevelCell;
import layout::MergeParameters;
import package::lib::dispatch::linearWorkgroup;
import package::lib::level_link::{blobError, errorOf, linkOf};
import package::lib::merged_cell::{chunksOf, countBitsBefore, leafAbove};
import package::lib::merged_splat::{Merged, meanArea, merge, mergeCost, mergedOf, opacityOf, rimLength, shapeOf};
import package::lib::packing::GEOMETRY_VECTORS;
import package::lib::packing::Splat;
import package::lib::packing::unpackSplat;

@group(0) @binding(0) var<uniform> parameters: MergeParameters;
@group(0) @binding(1) var<storage, read> cells: array<LevelCell>;
/// Of all levels above the chunks': leaves of cell u of these are chunk 2u, and its blobs 2u + 1.
@group(0) @binding(2) var<storage, read_write> upper: array<array<vec4u, 4>>;
@group(0) @binding(3) var<storage, read_write> upperLinks: array<ChunkLinks>;
@if(!UPPER) @group(0) @binding(4) var<storage, read_write> blobs: array<array<vec4u, 4>>;
@if(!UPPER) @group(0) @binding(5) var<storage, read_write> blobLinks: array<ChunkLinks>;
@if(!UPPER) @group(0) @binding(6) var<storage, read> splats: array<array<vec4u, GEOMETRY_VECTORS>>;
@if(!UPPER) @group(0) @binding(7) var<storage, read_write> splatLinks: array<ChunkLinks>;
@if(!GEOMETRY_F32) @group(0) @binding(8) var<storage, read> chunks: array<Chunk>;

const NODE_WORDS = 13u;
/// Places that a node's search for a neighbour covers, including its own.
const PLACES = 2u * MERGED_RADIUS + 1u;
/// Squares of longer lengths leave float32's range.
const FARTHEST = 1.8e19;

var<workgroup> nodes: array<array<f32, NODE_WORDS>, CHUNK_SPLATS>;
/// By thread with a node: the thread whose node is cheapest to merge with, or the thread itself.
var<workgroup> nearest: array<u32, CHUNK_SPLATS>;
/// While neighbours are sought: the threads that have nodes, ascending. While pairs merge: the error
/// of each thread's node, for its partner.
var<workgroup> order: array<u32, CHUNK_SPLATS>;
/// Threads that have nodes.
var<workgroup> nodeCount: u32;
/// A bit per thread: whether it has a node. A bit per thread or slot that `countBelow` counts next.
var<workgroup> holders: array<atomic<u32>, MASK_WORDS>;
var<workgroup> counted: array<atomic<u32>, MASK_WORDS>;
/// Bits of the largest standard deviation of splats, and of blobs.
var<workgroup> largestScale: array<atomic<u32>, 2>;
/// Complements of the least errors of splats and blobs.
var<workgroup> leastErrors: array<atomic<u32>, 2>;
var<workgroup> largestParentError: atomic<u32>;
var<workgroup> cellError: atomic<u32>;

/// The parts of a thread's node that no other thread reads.
struct Own {
  isActive: bool,
  /// Whether the node is a splat; otherwise it is the blob in `slot`.
  isSplat: bool,
  slot: u32,
  error: u32,
  /// Sums over its splats: opacity times rim length, in the cloud's units, and opacity.
  sums: vec2f,
}

@compute @workgroup_size(CHUNK_SPLATS)
fn mergeChunks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let cell = parameters.firstCell + linearWorkgroup(workgroup, parameters.dispatchRow);
  if (cell >= parameters.endCell) { return; }
  let chunk = chunksOf(parameters, cell);
  let splatChunk = chunk.x;
  let blobChunk = chunk.y;

  // Positions are halved first: their difference may leave float32's range.
  let halfSize = 0.5 * cells[cell].maxPosition - 0.5 * cells[cell].minPosition;
  var own = ownSplat(splatChunk, lane);
  var splat: Splat;
  if (own.isActive) {
    splat = splatOf(splatChunk, lane);
    atomicMax(&largestScale[0], bitcast<u32>(max(splat.scale.x, max(splat.scale.y, splat.scale.z))));
  }
  workgroupBarrier();
  // A power of two.
  let largest = max(max(halfSize.x, max(halfSize.y, halfSize.z)), bitcast<f32>(atomicLoad(&largestScale[0])));
  let unit = bitcast<f32>(clamp(bitcast<u32>(largest) & 0x7f800000u, 0x10000000u, 0x6f800000u));
  // Its inverse: devices may round when they divide.
  let perUnit = bitcast<f32>(0x7f000000u - bitcast<u32>(unit));
  if (own.isActive) {
    setNode(lane, mergedOf(splat, perUnit));
    @if(!UPPER) let axes = splat.scale * perUnit;
    @if(!UPPER) own.sums = splat.opacity * vec2f(unit * rimLength(axes, meanArea(axes)), 1.0);
    @if(UPPER) own.sums = sumsOf(splatChunk, lane);
    atomicMax(&leastErrors[0], ~own.error);
    atomicOr(&holders[lane / 32u], 1u << (lane % 32u));
  }
  workgroupBarrier();

  var made = 0u;
  for (var round = 0u; round < CHUNK_SPLATS; round++) {
    if (own.isActive) { order[countBelow(lane, false)] = lane; }
    if (lane == 0u) { nodeCount = countBelow(CHUNK_SPLATS, false); }
    let count = workgroupUniformLoad(&nodeCount);
    if (count <= CELL_ROOTS) { break; }
    // Work for any node is done by the first `count` threads, so that whole subgroups stay idle.
    if (lane < count) { nearest[order[lane]] = nearestTo(lane, count); }
    workgroupBarrier();

    let other = nearest[lane];
    let first = min(lane, other);
    let isPair = own.isActive && other != lane && nearest[other] == lane;
    order[lane] = own.error;
    if (isPair && lane == first) { atomicOr(&counted[lane / 32u], 1u << (lane % 32u)); }
    workgroupBarrier();

    // The last round merges no more pairs than leave CELL_ROOTS nodes.
    let pair = countBelow(first, true);
    let pairs = min(countBelow(CHUNK_SPLATS, true), count - CELL_ROOTS);
    let merges = isPair && pair < pairs;
    var blob: Merged;
    var error = 0u;
    if (merges) {
      let a = nodeOf(first);
      let b = nodeOf(max(lane, other));
      let moved = min(sqrt(sqrt(mergeCost(a, b))) * unit, FARTHEST);
      error = max(blobError(moved * moved), max(own.error, order[other]));
      blob = merge(a, b);
    }
    workgroupBarrier();
    if (lane < MASK_WORDS) { atomicStore(&counted[lane], 0u); }
    if (merges) {
      link(splatChunk, blobChunk, lane, own, linkOf(own.error, error, made + pair));
      own.isActive = lane == first;
      own.isSplat = false;
      own.slot = made + pair;
      own.error = error;
    }
    if (merges && lane == first) { setNode(lane, blob); }
    if (merges && lane != first) {
      atomicAnd(&holders[lane / 32u], ~(1u << (lane % 32u)));
      // This thread's node is gone, so its words carry its sums to the first thread of the pair.
      nodes[lane][0] = own.sums.x;
      nodes[lane][1] = own.sums.y;
    }
    workgroupBarrier();
    if (merges && lane == first) {
      own.sums += vec2f(nodes[other][0], nodes[other][1]);
      writeBlob(blobChunk, own.slot, packed(blob, own.sums, unit, cell));
      atomicMax(&leastErrors[1], ~error);
    }
    made += pairs;
  }

  // A splat without a partner becomes a root, as a blob of this splat alone.
  let pairs = made;
  let isAlone = own.isActive && own.isSplat;
  if (isAlone) { atomicOr(&counted[lane / 32u], 1u << (lane % 32u)); }
  workgroupBarrier();
  if (isAlone) {
    own.slot = made + countBelow(lane, true);
    let error = max(own.error, 1u);
    link(splatChunk, blobChunk, lane, own, linkOf(own.error, error, own.slot));
    own.isSplat = false;
    own.error = error;
    writeBlob(blobChunk, own.slot, packed(nodeOf(lane), own.sums, unit, cell));
    atomicMax(&leastErrors[1], ~error);
  }
  made += countBelow(CHUNK_SPLATS, true);
  workgroupBarrier();
  if (lane < MASK_WORDS) { atomicStore(&counted[lane], 0u); }
  workgroupBarrier();
  if (own.isActive) {
    link(splatChunk, blobChunk, lane, own, linkOf(own.error, ERROR_BOUNDLESS, 0u));
    atomicMax(&cellError, own.error);
    atomicOr(&counted[own.slot / 32u], 1u << (own.slot % 32u));
  }
  workgroupBarrier();
  let ownError = atomicLoad(&cellError);
  if (own.isActive && parameters.hasNextLevel == 1u) {
    let leaf = leafAbove(parameters, cell, countBelow(own.slot, true));
    let root = blobChunk * CHUNK_SPLATS + own.slot;
    @if(!UPPER) upper[leaf.x * CHUNK_SPLATS + leaf.y] = blobs[root];
    @if(UPPER) upper[leaf.x * CHUNK_SPLATS + leaf.y] = upper[root];
    upperLinks[leaf.x].links[leaf.y] = linkOf(ownError, 0u, 0u);
  }
  if (lane == 0u) { setHeads(splatChunk, blobChunk, cell, ownError, made, pairs); }
}

fn ownSplat(splatChunk: u32, lane: u32) -> Own {
  // Several chunks of a dispatch may be partly filled: their links count the empty slots.
  @if(!UPPER) let end = CHUNK_SPLATS - splatLinks[splatChunk].uncounted;
  @if(!UPPER) let isSplat = lane < end && splatChunk * CHUNK_SPLATS + lane < parameters.splatCount;
  @if(!UPPER) return Own(isSplat, true, 0u, 0u, vec2f(0.0));
  @if(UPPER) let error = errorOf(upperLinks[splatChunk].links[lane]);
  @if(UPPER) return Own(error > 0u, true, 0u, error, vec2f(0.0));
}

@if(!UPPER)
fn splatOf(chunk: u32, lane: u32) -> Splat {
  let index = chunk * CHUNK_SPLATS + lane;
  @if(GEOMETRY_F32) return unpackSplat(splats[index]);
  @if(!GEOMETRY_F32) return unpackSplat(splats[index], vec2f(chunks[chunk].minLogScale, chunks[chunk].logScaleStep));
}

@if(UPPER)
fn splatOf(chunk: u32, lane: u32) -> Splat {
  return unpackSplat(upper[chunk * CHUNK_SPLATS + lane]);
}

@if(UPPER)
fn sumsOf(chunk: u32, lane: u32) -> vec2f {
  let index = chunk * CHUNK_SPLATS + lane;
  return bitcast<vec2f>(vec2u(upper[index][2].w, upper[index][3].w));
}

/// Number of threads before `lane` that have nodes, or of the bits before it in `counted`.
fn countBelow(lane: u32, ofCounted: bool) -> u32 {
  var count = 0u;
  for (var word = 0u; word < MASK_WORDS; word++) {
    let bits = select(atomicLoad(&holders[word]), atomicLoad(&counted[word]), ofCounted);
    count += countBitsBefore(bits, word, lane);
  }
  return count;
}

/// The thread whose node is cheapest to merge with the node of the thread `order[rank]`; that thread
/// itself if its node has no neighbour. `count` threads have nodes.
fn nearestTo(rank: u32, count: u32) -> u32 {
  var found = order[rank];
  let node = nodeOf(found);
  var least = 1e38;
  // In ascending order, so that both sides prefer the first of equal costs.
  for (var step = 0u; step < PLACES; step++) {
    // Places before the first wrap around to more than `count`.
    let place = rank + step - MERGED_RADIUS;
    if (place == rank || place >= count) { continue; }
    let other = order[place];
    // The operands' order must not depend on the side.
    var cost = 0.0;
    if (place < rank) { cost = mergeCost(nodeOf(other), node); } else { cost = mergeCost(node, nodeOf(other)); }
    if (cost < least) {
      least = cost;
      found = other;
    }
  }
  return found;
}

fn nodeOf(lane: u32) -> Merged {
  let n = &nodes[lane];
  return Merged(
    vec3f((*n)[0], (*n)[1], (*n)[2]),
    (*n)[3],
    vec3f((*n)[4], (*n)[5], (*n)[6]),
    vec3f((*n)[7], (*n)[8], (*n)[9]),
    vec3f((*n)[10], (*n)[11], (*n)[12]),
  );
}

fn setNode(lane: u32, m: Merged) {
  nodes[lane] = array<f32, NODE_WORDS>(
    m.center.x, m.center.y, m.center.z, m.weight,
    m.variance.x, m.variance.y, m.variance.z,
    m.covariance.x, m.covariance.y, m.covariance.z,
    m.color.x, m.color.y, m.color.z,
  );
}

/// A blob as float32 geometry, with its sums in the words that splats leave empty.
fn packed(blob: Merged, sums: vec2f, unit: f32, cell: u32) -> array<vec4u, 4> {
  let shape = shapeOf(blob);
  let opacity = min(opacityOf(blob.weight, shape), MOST_OPACITY);
  let scale = shape.scale * unit;
  atomicMax(&largestScale[1], bitcast<u32>(max(scale.x, max(scale.y, scale.z))));
  // Rounding must not move it out of the cell.
  let position = clamp(unit * blob.center, cells[cell].minPosition, cells[cell].maxPosition);
  return array<vec4u, 4>(
    vec4u(bitcast<vec3u>(position), bitcast<u32>(opacity)),
    bitcast<vec4u>(shape.rotation),
    vec4u(bitcast<vec3u>(scale), bitcast<u32>(sums.x)),
    vec4u(bitcast<vec3u>(blob.color), bitcast<u32>(sums.y)),
  );
}

fn writeBlob(chunk: u32, slot: u32, blob: array<vec4u, 4>) {
  @if(!UPPER) blobs[chunk * CHUNK_SPLATS + slot] = blob;
  @if(UPPER) upper[chunk * CHUNK_SPLATS + slot] = blob;
}

/// Writes the link of a thread's node.
fn link(splatChunk: u32, blobChunk: u32, lane: u32, own: Own, bits: u32) {
  if (own.isSplat) { atomicMax(&largestParentError, (bits >> 12u) & 0xfffu); }
  @if(!UPPER) if (own.isSplat) { splatLinks[splatChunk].links[lane] = bits; }
  @if(!UPPER) if (!own.isSplat) { blobLinks[blobChunk].links[own.slot] = bits; }
  @if(UPPER) let chunk = select(blobChunk, splatChunk, own.isSplat);
  @if(UPPER) upperLinks[chunk].links[select(own.slot, lane, own.isSplat)] = bits;
}

/// Writes the facts of both chunks before their links. Keeps an error that the cell has already.
fn setHeads(splatChunk: u32, blobChunk: u32, cell: u32, error: u32, blobCount: u32, pairs: u32) {
  let splatScale = bitcast<f32>(atomicLoad(&largestScale[0]));
  let blobScale = bitcast<f32>(atomicLoad(&largestScale[1]));
  let leastSplat = ~atomicLoad(&leastErrors[0]);
  let leastBlob = ~atomicLoad(&leastErrors[1]);
  @if(!UPPER) let ofSplats = &splatLinks[splatChunk];
  @if(UPPER) let ofSplats = &upperLinks[splatChunk];
  @if(!UPPER) let ofBlobs = &blobLinks[blobChunk];
  @if(UPPER) let ofBlobs = &upperLinks[blobChunk];
  // The file of a brick tells its cells' errors, which devices may round differently.
  let known = (*ofSplats).cellError;
  let ownError = select(error, known, known > 0u);
  (*ofSplats).cell = cell;
  (*ofSplats).cellError = ownError;
  (*ofSplats).leastError = leastSplat;
  (*ofSplats).largestParentError = atomicLoad(&largestParentError);
  (*ofSplats).largestScale = splatScale;
  (*ofBlobs).cell = cell;
  (*ofBlobs).cellError = ownError;
  (*ofBlobs).leastError = leastBlob;
  (*ofBlobs).largestParentError = ERROR_BOUNDLESS;
  (*ofBlobs).largestScale = blobScale;
  (*ofBlobs).count = blobCount;
  (*ofBlobs).pairs = pairs;
}
