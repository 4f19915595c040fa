// Last step of a radix pass: moves every key and payload to its place.
// Reads keys, payloads and the scanned digit counts; writes keys and payloads. One workgroup per tile of SORT_TILE keys.
// Stable: within a tile, keys are taken in rounds of one per thread, and a key's rank among equal digits of its round is the
// number of set bits before its own in that digit's mask.
import constants::DIGIT_BITS;
import constants::SORT_ITEMS;
import constants::SORT_TILE;
import constants::SORT_WORKGROUP;
import layout::SortParameters;
import layout::SortPlan;
import package::lib::dispatch::linearWorkgroup;

const RADIX = 1u << DIGIT_BITS;
const ROUND_WORDS = SORT_WORKGROUP / 32u;

@group(0) @binding(0) var<uniform> parameters: SortParameters;
@group(0) @binding(1) var<storage, read> plan: SortPlan;
/// First place for the keys of each digit and tile: the scanned digitCounts.
@group(0) @binding(2) var<storage, read> digitOffsets: array<u32>;
@group(0) @binding(3) var<storage, read> keysIn: array<u32>;
@group(0) @binding(4) var<storage, read_write> payloadsOut: array<u32>;
@group(0) @binding(5) var<storage, read> payloadsIn: array<u32>;
@group(0) @binding(6) var<storage, read_write> keysOut: array<u32>;

/// Next place per digit.
var<workgroup> nextPlace: array<u32, RADIX>;
/// A bit per digit and thread of the round; word by word, so that threads of one word hit different banks.
var<workgroup> masks: array<atomic<u32>, ROUND_WORDS * RADIX>;

@compute @workgroup_size(SORT_WORKGROUP)
fn sortScatter(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let tile = linearWorkgroup(workgroup, parameters.dispatchRow);
  if (tile >= plan.tileCount) { return; }
  for (var digit = lane; digit < RADIX; digit += SORT_WORKGROUP) {
    nextPlace[digit] = digitOffsets[digit * plan.tileCount + tile];
  }
  let word = lane / 32u;
  let bit = 1u << (lane % 32u);
  for (var item = 0u; item < SORT_ITEMS; item++) {
    let index = tile * SORT_TILE + item * SORT_WORKGROUP + lane;
    let isKey = index < plan.keyCount;
    var key = 0u;
    var digit = 0u;
    if (isKey) {
      key = keysIn[index];
      digit = extractBits(key, parameters.digitShift, DIGIT_BITS);
      atomicOr(&masks[word * RADIX + digit], bit);
    }
    workgroupBarrier();

    var place = 0u;
    var rank = 0u;
    if (isKey) {
      rank = countOneBits(atomicLoad(&masks[word * RADIX + digit]) & (bit - 1u));
      for (var before = 0u; before < word; before++) { rank += countOneBits(atomicLoad(&masks[before * RADIX + digit])); }
      place = nextPlace[digit] + rank;
    }
    workgroupBarrier();

    if (isKey) {
      // The first key of each digit prepares the digit for the next round; all threads already have their places.
      if (rank == 0u) {
        var total = 0u;
        for (var w = 0u; w < ROUND_WORDS; w++) { total += countOneBits(atomicExchange(&masks[w * RADIX + digit], 0u)); }
        nextPlace[digit] += total;
      }
      // The payload of the first pass is each key's own index, and no later pass reads the keys of the last one. A uniform
      // decides, because one shader for all passes compiles in a third of the time of three.
      var payload = index;
      if (parameters.isFirst == 0u) { payload = payloadsIn[index]; }
      payloadsOut[place] = payload;
      if (parameters.isLast == 0u) { keysOut[place] = key; }
    }
    workgroupBarrier();
  }
}
