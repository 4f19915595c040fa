// Last step of a radix pass: moves every key and payload to its place. Reads keys, payloads and the
// scanned digit counts; writes keys and payloads. One workgroup per block of SORT_BLOCK keys. A
// block is sorted in workgroup memory first and then written in order, so that the keys of one digit
// leave in one run: scattered writes took most of a pass before. Stable: groups of threads take
// successive keys of the block, in rounds of one key per thread, and a key's rank is the number of
// its digit's keys in the group's earlier rounds and, in this round, at earlier threads. Groups are
// subgroups, whose threads learn of each other's digits by ballots, or else 16 threads that set bits
// of a mask in workgroup memory. With NARROW one thread moves the keys of a block one after another.
import constants::DIGIT_BITS;
@if(!NARROW) import constants::SORT_ITEMS;
import constants::SORT_BLOCK;
@if(!NARROW) import constants::SORT_GROUP;
import constants::SORT_WORKGROUP;
import layout::SortParameters;
import layout::SortPlan;
import package::lib::dispatch::linearWorkgroup;

const RADIX = 1u << DIGIT_BITS;
/// Most groups: SORT_GROUP is the size of the smallest.
@if(!NARROW) const GROUPS = SORT_WORKGROUP / SORT_GROUP;
/// Successive threads whose digits are summed by one of them.
@if(!NARROW) const RUN = 16u;
@if(!NARROW) const RUNS = SORT_WORKGROUP / RUN;
/// Successive digits that one thread prepares.
@if(!NARROW) const THREAD_DIGITS = (RADIX + SORT_WORKGROUP - 1u) / SORT_WORKGROUP;

@group(0) @binding(0) var<uniform> parameters: SortParameters;
@group(0) @binding(1) var<storage, read> plan: SortPlan;
/// Number of each digit's keys in the blocks before each block: the scanned digitCounts.
@group(0) @binding(2) var<storage, read> digitOffsets: array<u32>;
@group(0) @binding(3) var<storage, read> digitTotals: array<u32>;
@group(0) @binding(4) var<storage, read> keysIn: array<u32>;
@group(0) @binding(5) var<storage, read_write> payloadsOut: array<u32>;
@group(0) @binding(6) var<storage, read> payloadsIn: array<u32>;
@group(0) @binding(7) var<storage, read_write> keysOut: array<u32>;

/// One after another: a word per group and digit, the block's keys, the block's payloads. With
/// masks, a word has the mask of the round in its lower half and the number of keys of earlier
/// rounds in its upper half; otherwise it has this number.
@if(!NARROW) var<workgroup> words: array<atomic<u32>, max(SORT_BLOCK, GROUPS * RADIX)>;
/// Place of each digit's first key of this block, less its place within the block; modulo 2³².
@if(!NARROW) var<workgroup> shifts: array<u32, RADIX>;
@if(!NARROW) var<workgroup> threadSums: array<vec2u, SORT_WORKGROUP>;
@if(!NARROW) var<workgroup> runSums: array<vec2u, RUNS>;
@if(SUBGROUPS && !NARROW) var<workgroup> groupCount: atomic<u32>;

/// Threads that rank keys together.
@if(!NARROW)
struct Group {
  index: u32,
  /// This thread's place in it.
  lane: u32,
  size: u32,
}

@if(SUBGROUPS && !NARROW)
@compute @workgroup_size(SORT_WORKGROUP)
fn sortScatter(
  @builtin(workgroup_id) workgroup: vec3u,
  @builtin(local_invocation_index) lane: u32,
  @builtin(subgroup_invocation_id) groupLane: u32,
  @builtin(subgroup_size) groupSize: u32,
) {
  // Which threads a subgroup consists of is not specified, so that the groups number themselves.
  var index = 0u;
  if (subgroupElect()) { index = atomicAdd(&groupCount, 1u); }
  scatterBlock(linearWorkgroup(workgroup, parameters.dispatchRow), lane, Group(subgroupBroadcastFirst(index), groupLane, groupSize));
}

@if(!SUBGROUPS && !NARROW)
@compute @workgroup_size(SORT_WORKGROUP)
fn sortScatter(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let group = Group(lane / SORT_GROUP, lane % SORT_GROUP, SORT_GROUP);
  scatterBlock(linearWorkgroup(workgroup, parameters.dispatchRow), lane, group);
}

@if(!NARROW)
fn scatterBlock(block: u32, lane: u32, group: Group) {
  if (block >= plan.blockCount) { return; }
  let blockStart = block * SORT_BLOCK;
  let blockKeys = min(SORT_BLOCK, plan.keyCount - blockStart);

  let firstItem = group.index * group.size * SORT_ITEMS + group.lane;
  var keys: array<u32, SORT_ITEMS>;
  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    let place = firstItem + item * group.size;
    if (place < blockKeys) { keys[item] = keysIn[blockStart + place]; }
  }
  let localStart = prepareDigits(lane, block);

  // Ranks within the group and digit; later places within the block.
  var places: array<u32, SORT_ITEMS>;
  @unroll for (var item = 0u; item < SORT_ITEMS; item++) {
    let isKey = firstItem + item * group.size < blockKeys;
    places[item] = rank(digitOf(keys[item]), isKey, group);
  }
  workgroupBarrier();

  // Counts of each group and digit become their places within the block.
  var running = localStart;
  for (var i = 0u; i < THREAD_DIGITS; i++) {
    let digit = lane * THREAD_DIGITS + i;
    if (digit >= RADIX) { break; }
    for (var each = 0u; each < GROUPS; each++) {
      let count = countOf(atomicLoad(&words[each * RADIX + digit]));
      atomicStore(&words[each * RADIX + digit], running);
      running += count;
    }
  }
  workgroupBarrier();

  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    places[item] += atomicLoad(&words[group.index * RADIX + digitOf(keys[item])]);
  }
  workgroupBarrier();

  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    if (firstItem + item * group.size < blockKeys) { atomicStore(&words[places[item]], keys[item]); }
  }
  workgroupBarrier();

  // From here on a thread's items are the ones at its places of the sorted block.
  var targets: array<u32, SORT_ITEMS>;
  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    let place = item * SORT_WORKGROUP + lane;
    if (place < blockKeys) {
      let key = atomicLoad(&words[place]);
      targets[item] = shifts[digitOf(key)] + place;
      // A uniform decides: one shader for all passes compiles in a third of the time of three.
      if (parameters.writesKeys != 0u) { keysOut[targets[item]] = key; }
    }
  }
  workgroupBarrier();

  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    let place = firstItem + item * group.size;
    if (place < blockKeys) {
      var payload = blockStart + place;
      if (parameters.makesPayloads == 0u) { payload = payloadsIn[payload]; }
      atomicStore(&words[places[item]], payload);
    }
  }
  workgroupBarrier();

  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    let place = item * SORT_WORKGROUP + lane;
    if (place < blockKeys) { payloadsOut[targets[item]] = atomicLoad(&words[place]); }
  }
}

/// Keys of a digit that the group had in earlier rounds, or has in this one at earlier threads.
@if(SUBGROUPS && !NARROW)
fn rank(digit: u32, isKey: bool, group: Group) -> u32 {
  // Threads of the group whose keys have the same digit, as bits.
  var peers = subgroupBallot(isKey);
  @unroll for (var bit = 0u; bit < DIGIT_BITS; bit++) {
    let isSet = ((digit >> bit) & 1u) == 1u;
    let withBit = subgroupBallot(isSet);
    peers &= select(~withBit, withBit, isSet);
  }
  let first = firstOf(peers, group.lane);
  var start = 0u;
  // Only the shuffle waits for the sum: a group's round begins when the last has been counted.
  if (isKey && first == group.lane) { start = atomicAdd(&words[group.index * RADIX + digit], countOf4(peers)); }
  return subgroupShuffle(start, first) + countOf4(peers & before(group.lane));
}

/// The lowest set bit; `lane` if none is set.
@if(SUBGROUPS && !NARROW && !WIDE_SUBGROUPS)
fn firstOf(bits: vec4u, lane: u32) -> u32 {
  return select(firstTrailingBit(bits.x), lane, bits.x == 0u);
}

@if(SUBGROUPS && !NARROW && WIDE_SUBGROUPS)
fn firstOf(bits: vec4u, lane: u32) -> u32 {
  var first = lane;
  if (bits.w != 0u) { first = 96u + firstTrailingBit(bits.w); }
  if (bits.z != 0u) { first = 64u + firstTrailingBit(bits.z); }
  if (bits.y != 0u) { first = 32u + firstTrailingBit(bits.y); }
  if (bits.x != 0u) { first = firstTrailingBit(bits.x); }
  return first;
}

@if(SUBGROUPS && !NARROW && !WIDE_SUBGROUPS)
fn countOf4(bits: vec4u) -> u32 {
  return countOneBits(bits.x);
}

@if(SUBGROUPS && !NARROW && WIDE_SUBGROUPS)
fn countOf4(bits: vec4u) -> u32 {
  let counts = countOneBits(bits);
  return counts.x + counts.y + counts.z + counts.w;
}

/// The bits below the bit of `lane`.
@if(SUBGROUPS && !NARROW)
fn before(lane: u32) -> vec4u {
  let lanes = vec4u(0u, 32u, 64u, 96u);
  let inWord = clamp(vec4i(i32(lane)) - vec4i(lanes), vec4i(0), vec4i(32));
  return select((vec4u(1u) << vec4u(inWord)) - 1u, vec4u(0xffffffffu), inWord == vec4i(32));
}

@if(SUBGROUPS && !NARROW)
fn countOf(word: u32) -> u32 {
  return word;
}

@if(!SUBGROUPS && !NARROW)
fn rank(digit: u32, isKey: bool, group: Group) -> u32 {
  let bit = 1u << group.lane;
  let slot = group.index * RADIX + digit;
  if (isKey) { atomicAdd(&words[slot], bit); }
  workgroupBarrier();

  var word = 0u;
  if (isKey) { word = atomicLoad(&words[slot]); }
  let before = word & (bit - 1u);
  workgroupBarrier();

  // The first thread of each digit turns the mask into a count. Sums commute, so that threads which
  // already add the next round's bits need not wait: an addition to a bit that is still set is
  // carried, and the subtraction takes it back.
  if (isKey && before == 0u) {
    let mask = word & 0xffffu;
    atomicAdd(&words[slot], (countOneBits(mask) << 16u) - mask);
  }
  return (word >> 16u) + countOneBits(before);
}

@if(!SUBGROUPS && !NARROW)
fn countOf(word: u32) -> u32 {
  return word >> 16u;
}

fn digitOf(key: u32) -> u32 {
  return extractBits(key, parameters.digitShift, DIGIT_BITS);
}

/// Number of the digit's keys in all blocks, and in this one. Two rows of scanned counts differ by
/// a block's counts, so the block need not be counted again.
@if(!NARROW)
fn digitCounts(digit: u32, block: u32) -> vec2u {
  let total = digitTotals[digit];
  let offset = digit * plan.blockCount + block;
  var end = total;
  if (block + 1u < plan.blockCount) { end = digitOffsets[offset + 1u]; }
  return vec2u(total, end - digitOffsets[offset]);
}

/// Scans the digits' counts over the digits: writes `shifts` and returns the place within the block
/// of the first key with one of this thread's digits. The caller's next barrier makes `shifts`
/// visible.
@if(!NARROW)
fn prepareDigits(lane: u32, block: u32) -> u32 {
  var sum = vec2u(0u);
  for (var i = 0u; i < THREAD_DIGITS; i++) {
    let digit = lane * THREAD_DIGITS + i;
    if (digit < RADIX) { sum += digitCounts(digit, block); }
  }
  threadSums[lane] = sum;
  workgroupBarrier();

  // Twice up to 16 additions take two barriers; a tree over 256 threads takes 16.
  let run = lane / RUN;
  let runStart = run * RUN;
  var start = vec2u(0u);
  for (var other = runStart; other < lane; other++) { start += threadSums[other]; }
  if (lane % RUN == RUN - 1u) { runSums[run] = start + sum; }
  workgroupBarrier();

  for (var other = 0u; other < run; other++) { start += runSums[other]; }
  let localStart = start.y;
  for (var i = 0u; i < THREAD_DIGITS; i++) {
    let digit = lane * THREAD_DIGITS + i;
    if (digit < RADIX) {
      shifts[digit] = start.x + digitOffsets[digit * plan.blockCount + block] - start.y;
      start += digitCounts(digit, block);
    }
  }
  return localStart;
}

@if(NARROW)
@compute @workgroup_size(SORT_WORKGROUP)
fn sortScatter(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let block = linearWorkgroup(workgroup, parameters.dispatchRow) * SORT_WORKGROUP + lane;
  if (block >= plan.blockCount) { return; }
  // Where the next key with each digit goes.
  var places: array<u32, RADIX>;
  var digitStart = 0u;
  for (var digit = 0u; digit < RADIX; digit++) {
    places[digit] = digitStart + digitOffsets[digit * plan.blockCount + block];
    digitStart += digitTotals[digit];
  }
  let start = block * SORT_BLOCK;
  let end = min(start + SORT_BLOCK, plan.keyCount);
  for (var index = start; index < end; index++) {
    let key = keysIn[index];
    let place = places[digitOf(key)];
    places[digitOf(key)] = place + 1u;
    if (parameters.writesKeys != 0u) { keysOut[place] = key; }
    var payload = index;
    if (parameters.makesPayloads == 0u) { payload = payloadsIn[index]; }
    payloadsOut[place] = payload;
  }
}
