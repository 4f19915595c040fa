// Averages the spherical harmonics above degree 0 of merged splats by weight. Reads the links and
// geometry that merge-chunks has written, and the harmonics of splats; writes the harmonics of blobs
// and of the next level's leaves, a byte each. One workgroup per cell, one thread per slot. With
// UPPER the splats are roots of the level below, in the buffer that blobs go to.
import constants::CHUNK_SPLATS;
import constants::ERROR_BOUNDLESS;
import constants::MASK_WORDS;
import constants::MERGED_SH_WORDS;
import constants::SH_VALUES;
import constants::SH_WORDS;
@if(!GEOMETRY_F32) import layout::Chunk;
import layout::ChunkLinks;
import layout::MergeParameters;
import package::lib::covariance::rotationMatrix;
import package::lib::dispatch::linearWorkgroup;
import package::lib::harmonics_packing::byteOf;
import package::lib::harmonics_packing::scaleBitsOf;
import package::lib::harmonics_packing::scaleOf;
import package::lib::level_link::{parentErrorOf, parentSlotOf};
import package::lib::merged_cell::{chunksOf, countBitsBefore, leafAbove};
import package::lib::merged_splat::weightOf;
import package::lib::packing::GEOMETRY_VECTORS;
import package::lib::packing::unpackSplat;

@group(0) @binding(0) var<uniform> parameters: MergeParameters;
@group(0) @binding(1) var<storage, read_write> upperSh: array<u32>;
@if(UPPER) @group(0) @binding(2) var<storage, read> upper: array<array<vec4u, 4>>;
@if(UPPER) @group(0) @binding(3) var<storage, read> upperLinks: array<ChunkLinks>;
@if(!UPPER) @group(0) @binding(4) var<storage, read_write> blobSh: array<u32>;
@if(!UPPER) @group(0) @binding(5) var<storage, read> blobs: array<array<vec4u, 4>>;
@if(!UPPER) @group(0) @binding(6) var<storage, read> blobLinks: array<ChunkLinks>;
@if(!UPPER) @group(0) @binding(7) var<storage, read> splats: array<array<vec4u, GEOMETRY_VECTORS>>;
@if(!UPPER) @group(0) @binding(8) var<storage, read> splatLinks: array<ChunkLinks>;
@if(!UPPER) @group(0) @binding(9) var<storage, read> shRest: array<u32>;
@if(!GEOMETRY_F32) @group(0) @binding(10) var<storage, read> chunks: array<Chunk>;

/// Coefficients that are averaged together: 9, 24 and 45 take 1, 3 and 5 rounds.
const GROUP = 9u;
const GROUPS = (SH_VALUES + GROUP - 1u) / GROUP;
/// In place of a second child: a blob of a single splat has none.
const NONE = 0xffffu;

/// Both nodes that a blob merges, in order so that sums are the same every time: slots of blobs, and
/// of splats from CHUNK_SPLATS on.
var<workgroup> firstChildren: array<atomic<u32>, CHUNK_SPLATS>;
var<workgroup> lastChildren: array<atomic<u32>, CHUNK_SPLATS>;
/// Weights of blobs, then of splats.
var<workgroup> weights: array<f32, 2u * CHUNK_SPLATS>;
/// First by blob: the step that averages it, 0 while unknown. Then by step: where it ends in
/// `order`.
var<workgroup> depths: array<atomic<u32>, CHUNK_SPLATS>;
/// Blobs by the step that averages them.
var<workgroup> order: array<u32, CHUNK_SPLATS>;
var<workgroup> orderedCount: atomic<u32>;
var<workgroup> values: array<f32, GROUP * CHUNK_SPLATS>;
/// A bit per root.
var<workgroup> roots: array<atomic<u32>, MASK_WORDS>;

@compute @workgroup_size(CHUNK_SPLATS)
fn mergeHarmonics(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let cell = parameters.firstCell + linearWorkgroup(workgroup, parameters.dispatchRow);
  if (cell >= parameters.endCell) { return; }
  let chunk = chunksOf(parameters, cell);
  let splatChunk = chunk.x;
  let blobChunk = chunk.y;
  @if(!UPPER) let splatLink = splatLinks[splatChunk].links[lane];
  @if(UPPER) let splatLink = upperLinks[splatChunk].links[lane];
  @if(!UPPER) let blobLink = blobLinks[blobChunk].links[lane];
  @if(UPPER) let blobLink = upperLinks[blobChunk].links[lane];

  @if(!UPPER) let largestScale = max(splatLinks[splatChunk].largestScale, blobLinks[blobChunk].largestScale);
  @if(UPPER) let largestScale = max(upperLinks[splatChunk].largestScale, upperLinks[blobChunk].largestScale);
  atomicStore(&firstChildren[lane], NONE);
  workgroupBarrier();
  if (splatLink != 0u) {
    adopt(parentSlotOf(splatLink), CHUNK_SPLATS + lane);
    weights[CHUNK_SPLATS + lane] = splatWeight(splatChunk, lane, largestScale);
  }
  if (blobLink != 0u) {
    weights[lane] = blobWeight(blobChunk, lane, largestScale);
    if (parentErrorOf(blobLink) == ERROR_BOUNDLESS) {
      atomicOr(&roots[lane / 32u], 1u << (lane % 32u));
    } else {
      adopt(parentSlotOf(blobLink), lane);
    }
  }
  workgroupBarrier();

  // A blob needs the harmonics of its children first.
  let isBlob = blobLink != 0u;
  @if(!UPPER) let blobCount = blobLinks[blobChunk].count;
  @if(UPPER) let blobCount = upperLinks[blobChunk].count;
  var isOrdered = false;
  // By the lane that has the number of the step.
  var end = 0u;
  var steps = 0u;
  for (var step = 1u; step <= CHUNK_SPLATS; step++) {
    let count = workgroupUniformLoad(&orderedCount);
    if (lane == steps) { end = count; }
    if (count >= blobCount) { break; }
    steps = step;
    if (isBlob && !isOrdered && isKnown(firstOf(lane), step) && isKnown(secondOf(lane), step)) {
      isOrdered = true;
      atomicStore(&depths[lane], step);
      order[atomicAdd(&orderedCount, 1u)] = lane;
    }
  }
  workgroupBarrier();
  atomicStore(&depths[lane], end);
  workgroupBarrier();

  let last = steps;
  // A thread for each coefficient of each blob of a step: threads of one blob read along its words.
  var averaged: array<f32, GROUPS * GROUP>;
  for (var group = 0u; group < GROUPS; group++) {
    for (var step = 1u; step <= last; step++) {
      let firstItem = GROUP * atomicLoad(&depths[step - 1u]) + lane;
      let endItem = GROUP * atomicLoad(&depths[step]);
      for (var item = firstItem; item < endItem; item += CHUNK_SPLATS) {
        let blob = order[item / GROUP];
        let i = item % GROUP;
        values[blob * GROUP + i] = averageOf(blob, splatChunk, group * GROUP + i, i);
      }
      workgroupBarrier();
    }
    for (var i = 0u; i < GROUP; i++) { averaged[group * GROUP + i] = values[lane * GROUP + i]; }
    workgroupBarrier();
  }
  if (blobLink == 0u) { return; }

  var largest = 0.0;
  for (var i = 0u; i < SH_VALUES; i++) { largest = max(largest, abs(averaged[i])); }
  let scaleBits = scaleBitsOf(largest);
  let scale = scaleOf(scaleBits);
  let leaf = leafAbove(parameters, cell, rootsBelow(lane));
  let isPromoted = parentErrorOf(blobLink) == ERROR_BOUNDLESS && parameters.hasNextLevel == 1u;
  for (var word = 0u; word < MERGED_SH_WORDS; word++) {
    var bits = select(0u, scaleBits, word == 0u);
    for (var part = 0u; part < 4u; part++) {
      let i = 4u * word + part;
      if (i >= 2u && i < SH_VALUES + 2u) { bits = insertBits(bits, byteOf(averaged[i - 2u], scale), 8u * part, 8u); }
    }
    writeWord((blobChunk * CHUNK_SPLATS + lane) * MERGED_SH_WORDS + word, bits);
    if (isPromoted) { upperSh[(leaf.x * CHUNK_SPLATS + leaf.y) * MERGED_SH_WORDS + word] = bits; }
  }
}

fn adopt(parent: u32, child: u32) {
  atomicMin(&firstChildren[parent], child);
  atomicMax(&lastChildren[parent], child);
}

fn firstOf(blob: u32) -> u32 {
  return atomicLoad(&firstChildren[blob]);
}

fn secondOf(blob: u32) -> u32 {
  let child = atomicLoad(&lastChildren[blob]);
  return select(child, NONE, child == firstOf(blob));
}

/// Whether a child has been averaged before this step.
fn isKnown(child: u32, step: u32) -> bool {
  if (child >= CHUNK_SPLATS) { return true; }
  let depth = atomicLoad(&depths[child]);
  return depth > 0u && depth < step;
}

/// Coefficient `k` of a blob, which is the group's `i`: its children's, by their weights.
fn averageOf(blob: u32, splatChunk: u32, k: u32, i: u32) -> f32 {
  if (k >= SH_VALUES) { return 0.0; }
  let child0 = firstOf(blob);
  let child1 = secondOf(blob);
  let first = childValue(child0, splatChunk, k, i);
  if (child1 == NONE) { return first; }
  let second = childValue(child1, splatChunk, k, i);
  let weight0 = weights[child0];
  let weight1 = weights[child1];
  return (weight0 * first + weight1 * second) / (weight0 + weight1);
}

fn childValue(child: u32, splatChunk: u32, k: u32, i: u32) -> f32 {
  if (child < CHUNK_SPLATS) { return values[child * GROUP + i]; }
  return splatValue(splatChunk * CHUNK_SPLATS + child - CHUNK_SPLATS, k);
}

fn rootsBelow(slot: u32) -> u32 {
  var count = 0u;
  for (var word = 0u; word < MASK_WORDS; word++) {
    count += countBitsBefore(atomicLoad(&roots[word]), word, slot);
  }
  return count;
}

fn writeWord(at: u32, bits: u32) {
  @if(!UPPER) blobSh[at] = bits;
  @if(UPPER) upperSh[at] = bits;
}

@if(!UPPER)
fn splatWeight(chunk: u32, lane: u32, unit: f32) -> f32 {
  let index = chunk * CHUNK_SPLATS + lane;
  @if(GEOMETRY_F32) let splat = unpackSplat(splats[index]);
  @if(!GEOMETRY_F32) let splat = unpackSplat(splats[index], vec2f(chunks[chunk].minLogScale, chunks[chunk].logScaleStep));
  return weightOf(splat.opacity, rotationMatrix(splat.rotation), splat.scale / unit);
}

@if(UPPER)
fn splatWeight(chunk: u32, lane: u32, unit: f32) -> f32 {
  return blobWeight(chunk, lane, unit);
}

fn blobWeight(chunk: u32, slot: u32, unit: f32) -> f32 {
  let index = chunk * CHUNK_SPLATS + slot;
  @if(!UPPER) let words = blobs[index];
  @if(UPPER) let words = upper[index];
  let rotation = rotationMatrix(bitcast<vec4f>(words[1]));
  return weightOf(bitcast<f32>(words[0].w), rotation, bitcast<vec3f>(words[2].xyz) / unit);
}

@if(!UPPER)
fn splatValue(index: u32, k: u32) -> f32 {
  @if(SH_PALETTE) return paletteValue(index, k);
  @if(SH_F32 && !SH_PALETTE) return bitcast<f32>(shRest[index * SH_WORDS + k]);
  @if(SH_F16) return unpack2x16float(shRest[index * SH_WORDS + k / 2u] >> (16u * (k % 2u))).x;
  @if(SH_U8) return byteValue(shRest[index * SH_WORDS], shRest[index * SH_WORDS + (k + 2u) / 4u], k);
}

@if(UPPER)
fn splatValue(index: u32, k: u32) -> f32 {
  return byteValue(upperSh[index * SH_WORDS], upperSh[index * SH_WORDS + (k + 2u) / 4u], k);
}

/// All entries of a palette come first, then the entry of each splat of the page, two to a word.
@if(SH_PALETTE)
fn paletteValue(index: u32, k: u32) -> f32 {
  let entries = arrayLength(&shRest) - (parameters.splatCount + 1u) / 2u;
  let entry = (shRest[entries + index / 2u] >> (16u * (index % 2u))) & 0xffffu;
  return bitcast<f32>(shRest[entry * SH_WORDS + k]);
}

/// Coefficient `k`, whose byte is in `word`, of a splat with the scale in its `first`.
@if(SH_U8)
fn byteValue(first: u32, word: u32, k: u32) -> f32 {
  let byte = extractBits(bitcast<i32>(word), 8u * ((k + 2u) % 4u), 8u);
  return f32(byte) / 127.0 * unpack2x16float(first).x;
}
