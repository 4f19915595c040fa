// Last step of a radix pass: moves every key and payload to its place. Reads keys, payloads and the
// scanned digit counts; writes keys and payloads. One workgroup per block of SORT_BLOCK keys. A
// block is sorted in workgroup memory first and then written in order, so that the keys of one digit
// leave in one run: scattered writes took most of a pass before. Stable: groups of threads take
// successive keys of the block, in rounds of one key per thread, and a key's rank is the number of
// its digit's keys in the group's earlier rounds and, in this round, at earlier threads. Groups are
// subgroups, whose threads learn of each other's digits by ballots, or else 16 threads that set bits
// of a mask in workgroup memory. The last block is filled up with keys of the last digit: their places
// lie behind all others and are not written. With NARROW one thread moves the keys of a block one
// after another.
import constants::DIGIT_BITS;
import constants::SORT_BLOCK;
@if(!NARROW) import constants::SORT_GROUP;
@if(!NARROW) import constants::SORT_ITEMS;
@if(!NARROW) import constants::SORT_ROWS;
@if(!NARROW) import constants::SORT_THREAD_DIGITS;
import constants::SORT_WORKGROUP;
import layout::SortParameters;
import layout::SortPlan;
import package::lib::dispatch::linearWorkgroup;

const RADIX = 1u << DIGIT_BITS;
/// Successive threads whose digits are summed by one of them.
@if(!SUBGROUPS && !NARROW) const RUN = 16u;
/// Fills up the last block: its digit is the last in every pass.
@if(!NARROW) const LAST_KEY = 0xffffffffu;

@group(0) @binding(0) var<uniform> parameters: SortParameters;
@group(0) @binding(1) var<storage, read> plan: SortPlan;
/// Number of each digit's keys in the blocks before each block: the scanned digitCounts.
@group(0) @binding(2) var<storage, read> digitOffsets: array<u32>;
@group(0) @binding(3) var<storage, read> digitTotals: array<u32>;
@group(0) @binding(4) var<storage, read> keysIn: array<u32>;
@group(0) @binding(5) var<storage, read_write> payloadsOut: array<u32>;
@group(0) @binding(6) var<storage, read> payloadsIn: array<u32>;
@group(0) @binding(7) var<storage, read_write> keysOut: array<u32>;

/// One after another: SORT_ROWS words per digit, the block's keys, the block's payloads. A digit has a
/// word for each group if ranks come from masks: the mask of the round in its lower half and the number
/// of keys of earlier rounds in its upper half. Otherwise a word has this number of two groups. Later,
/// halves have places: with masks, the lower ones.
@if(!NARROW) var<workgroup> words: array<atomic<u32>, max(SORT_BLOCK, SORT_ROWS * RADIX)>;
/// Place of each digit's first key of this block, less its place within the block; modulo 2³².
@if(!NARROW) var<workgroup> shifts: array<u32, RADIX>;
@if(!SUBGROUPS && !NARROW) var<workgroup> threadSums: array<vec2u, SORT_WORKGROUP>;
@if(!SUBGROUPS && !NARROW) var<workgroup> runSums: array<vec2u, SORT_WORKGROUP / RUN>;
/// SORT_GROUP is the size of the smallest group.
@if(SUBGROUPS && !NARROW) var<workgroup> groupSums: array<vec2u, SORT_WORKGROUP / SORT_GROUP>;
@if(SUBGROUPS && !NARROW) var<workgroup> groupCount: atomic<u32>;

/// Threads that rank keys together.
@if(!NARROW)
struct Group {
  index: u32,
  /// This thread's place in it.
  lane: u32,
  size: u32,
  /// Place of its first word.
  row: u32,
  /// Its lowest bit in these words.
  shift: u32,
}

@if(SUBGROUPS && !NARROW)
@compute @workgroup_size(SORT_WORKGROUP)
fn sortScatter(
  @builtin(workgroup_id) workgroup: vec3u,
  @builtin(subgroup_invocation_id) groupLane: u32,
  @builtin(subgroup_size) groupSize: u32,
) {
  // Which threads a subgroup consists of is not specified, so that the groups number themselves.
  var number = 0u;
  if (subgroupElect()) { number = atomicAdd(&groupCount, 1u); }
  let index = subgroupBroadcastFirst(number);
  let group = Group(index, groupLane, groupSize, index / 2u * RADIX, halfShift(index));
  scatterBlock(linearWorkgroup(workgroup, parameters.dispatchRow), group);
}

@if(!SUBGROUPS && !NARROW)
@compute @workgroup_size(SORT_WORKGROUP)
fn sortScatter(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = lane / SORT_GROUP;
  let group = Group(index, lane % SORT_GROUP, SORT_GROUP, index * RADIX, 0u);
  scatterBlock(linearWorkgroup(workgroup, parameters.dispatchRow), group);
}

@if(!NARROW)
fn scatterBlock(block: u32, group: Group) {
  if (block >= plan.blockCount) { return; }
  let thread = group.index * group.size + group.lane;
  let blockStart = block * SORT_BLOCK;
  let blockKeys = min(SORT_BLOCK, plan.keyCount - blockStart);

  let firstItem = group.index * group.size * SORT_ITEMS + group.lane;
  var keys: array<u32, SORT_ITEMS>;
  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    let place = firstItem + item * group.size;
    keys[item] = LAST_KEY;
    if (place < blockKeys) { keys[item] = keysIn[blockStart + place]; }
  }
  let localStart = prepareDigits(thread, block, group);

  // Ranks within the group and digit, then places within the block. Two share a word: registers
  // decide how many workgroups a processor of the GPU takes at a time.
  var places: array<u32, (SORT_ITEMS + 1) / 2>;
  @unroll for (var item = 0u; item < SORT_ITEMS; item++) {
    places[item / 2u] |= rank(keys[item], group) << halfShift(item);
  }
  workgroupBarrier();

  // Counts of each group and digit become their places within the block.
  var running = localStart;
  for (var i = 0u; i < SORT_THREAD_DIGITS; i++) {
    let digit = thread * SORT_THREAD_DIGITS + i;
    if (digit < RADIX) { running = placeGroups(digit, running); }
  }
  workgroupBarrier();

  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    let groupPlace = atomicLoad(&words[group.row + digitOf(keys[item])]) >> group.shift;
    places[item / 2u] += halfOf(groupPlace, 0u) << halfShift(item);
  }
  workgroupBarrier();

  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    atomicStore(&words[halfOf(places[item / 2u], item)], keys[item]);
  }
  workgroupBarrier();

  // Of the keys at this thread's places of the sorted block: they tell where the payloads go, too.
  var digits: array<u32, (SORT_ITEMS + 1) / 2>;
  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    let place = item * SORT_WORKGROUP + thread;
    let key = atomicLoad(&words[place]);
    digits[item / 2u] |= digitOf(key) << halfShift(item);
    // A uniform decides: one shader for all passes compiles in a third of the time of three.
    if (parameters.writesKeys != 0u && place < blockKeys) { keysOut[shifts[digitOf(key)] + place] = key; }
  }
  workgroupBarrier();

  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    let place = firstItem + item * group.size;
    var payload = blockStart + place;
    if (parameters.makesPayloads == 0u && place < blockKeys) { payload = payloadsIn[payload]; }
    atomicStore(&words[halfOf(places[item / 2u], item)], payload);
  }
  workgroupBarrier();

  @unroll(SUBGROUPS) for (var item = 0u; item < SORT_ITEMS; item++) {
    let place = item * SORT_WORKGROUP + thread;
    if (place < blockKeys) { payloadsOut[shifts[halfOf(digits[item / 2u], item)] + place] = atomicLoad(&words[place]); }
  }
}

/// Bits below the half of a word that belongs to one of two successive numbers.
@if(!NARROW)
fn halfShift(number: u32) -> u32 {
  return 16u * (number % 2u);
}

@if(!NARROW)
fn halfOf(word: u32, number: u32) -> u32 {
  return (word >> halfShift(number)) & 0xffffu;
}

/// Keys with the same digit that the group had in earlier rounds, or has in this one at earlier threads.
@if(SUBGROUPS && !NARROW)
fn rank(key: u32, group: Group) -> u32 {
  // Threads of the group whose keys have the same digit, as bits.
  var peers = subgroupBallot(true);
  @unroll for (var bit = 0u; bit < DIGIT_BITS; bit++) {
    // The mask is the same for all threads and keys: the digit's bits would be shifted for each.
    let isSet = (key & (1u << (parameters.digitShift + bit))) != 0u;
    peers &= subgroupBallot(isSet) ^ vec4u(select(0xffffffffu, 0u, isSet));
  }
  let earlier = countOf4(peers & before(group.lane));
  // The last of them counts all: the others are earlier.
  let last = lastOf(peers);
  var counts = 0u;
  // Only the shuffle waits for the sum: a group's round begins when the last has been counted.
  if (last == group.lane) {
    counts = atomicAdd(&words[group.row + digitOf(key)], (earlier + 1u) << group.shift);
  }
  return halfOf(subgroupShuffle(counts, last) >> group.shift, 0u) + earlier;
}

/// The highest set bit; there is one.
@if(SUBGROUPS && !NARROW && !WIDE_SUBGROUPS)
fn lastOf(bits: vec4u) -> u32 {
  return firstLeadingBit(bits.x);
}

@if(SUBGROUPS && !NARROW && WIDE_SUBGROUPS)
fn lastOf(bits: vec4u) -> u32 {
  if (bits.w != 0u) { return 96u + firstLeadingBit(bits.w); }
  if (bits.z != 0u) { return 64u + firstLeadingBit(bits.z); }
  if (bits.y != 0u) { return 32u + firstLeadingBit(bits.y); }
  return firstLeadingBit(bits.x);
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

@if(!SUBGROUPS && !NARROW)
fn rank(key: u32, group: Group) -> u32 {
  let bit = 1u << group.lane;
  let slot = group.row + digitOf(key);
  atomicAdd(&words[slot], bit);
  workgroupBarrier();

  let word = atomicLoad(&words[slot]);
  let before = word & (bit - 1u);
  workgroupBarrier();

  // The first thread of each digit turns the mask into a count. Sums commute, so that threads which
  // already add the next round's bits need not wait: an addition to a bit that is still set is
  // carried, and the subtraction takes it back.
  if (before == 0u) {
    let mask = word & 0xffffu;
    atomicAdd(&words[slot], (countOneBits(mask) << 16u) - mask);
  }
  return (word >> 16u) + countOneBits(before);
}

/// Turns the groups' counts of a digit into the places of their first keys within the block. Returns
/// the place behind the digit's last key.
@if(!NARROW)
fn placeGroups(digit: u32, start: u32) -> u32 {
  // All are read before the first is written: the reads then wait for memory together.
  var counts: array<u32, SORT_ROWS>;
  @unroll for (var row = 0u; row < SORT_ROWS; row++) { counts[row] = atomicLoad(&words[row * RADIX + digit]); }
  var running = start;
  @unroll for (var row = 0u; row < SORT_ROWS; row++) {
    // With masks, the lower half counts nothing any more.
    let middle = running + halfOf(counts[row], 0u);
    atomicStore(&words[row * RADIX + digit], running | (middle << 16u));
    running = middle + halfOf(counts[row], 1u);
  }
  return running;
}

fn digitOf(key: u32) -> u32 {
  return (key >> parameters.digitShift) & (RADIX - 1u);
}

/// Scans the digits' counts over the digits: writes `shifts` and returns the place within the block
/// of the first key with one of this thread's digits. The caller's next barrier makes `shifts`
/// visible.
@if(!NARROW)
fn prepareDigits(thread: u32, block: u32, group: Group) -> u32 {
  // Of each digit, its keys in earlier blocks, and its keys in all blocks and in this one.
  var offsets: array<u32, SORT_THREAD_DIGITS>;
  var counts: array<vec2u, SORT_THREAD_DIGITS>;
  var sum = vec2u(0u);
  @unroll for (var i = 0u; i < SORT_THREAD_DIGITS; i++) {
    let digit = thread * SORT_THREAD_DIGITS + i;
    if (digit < RADIX) {
      let total = digitTotals[digit];
      let place = digit * plan.blockCount + block;
      offsets[i] = digitOffsets[place];
      // Two rows of scanned counts differ by a block's counts, so the block need not be counted again.
      var end = total;
      if (block + 1u < plan.blockCount) { end = digitOffsets[place + 1u]; }
      counts[i] = vec2u(total, end - offsets[i]);
      sum += counts[i];
    }
  }
  var start = sumBefore(sum, thread, group);
  let localStart = start.y;
  @unroll for (var i = 0u; i < SORT_THREAD_DIGITS; i++) {
    let digit = thread * SORT_THREAD_DIGITS + i;
    if (digit < RADIX) { shifts[digit] = start.x + offsets[i] - start.y; }
    start += counts[i];
  }
  return localStart;
}

/// Sum of all earlier threads' values.
@if(SUBGROUPS && !NARROW)
fn sumBefore(value: vec2u, thread: u32, group: Group) -> vec2u {
  let inGroup = subgroupExclusiveAdd(value);
  if (group.lane == group.size - 1u) { groupSums[group.index] = inGroup + value; }
  workgroupBarrier();

  var earlier = vec2u(0u);
  for (var other = group.lane; other < group.index; other += group.size) { earlier += groupSums[other]; }
  return inGroup + subgroupAdd(earlier);
}

@if(!SUBGROUPS && !NARROW)
fn sumBefore(value: vec2u, thread: u32, group: Group) -> vec2u {
  threadSums[thread] = value;
  workgroupBarrier();

  // Twice up to 16 additions take two barriers; a tree over 256 threads takes 16.
  let run = thread / RUN;
  let runStart = run * RUN;
  var start = vec2u(0u);
  for (var other = runStart; other < thread; other++) { start += threadSums[other]; }
  if (thread % RUN == RUN - 1u) { runSums[run] = start + value; }
  workgroupBarrier();

  for (var other = 0u; other < run; other++) { start += runSums[other]; }
  return start;
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
