// Takes rows of a file as they arrive: drops rows that are not finite, packs the others, and
// gathers facts about them. Reads the rows' bytes, with harmonics that are float32 or bytes, and the
// palette that some rows take their harmonics from; writes planes in the order of the file, a slot
// per row, a `Chunk` for each 256 slots, and the facts. One thread per row, one workgroup per chunk.
// Rows that are dropped leave their slot as it is, zero, and so does a chunk without any others. Log
// scales are packed over the range of their chunk in the file, with a rest beside: ingest-chunks
// rounds them anew once splats are in storage order.
import constants::CHUNK_SPLATS;
import constants::ENTRY_VALUES;
import constants::FACTS;
import constants::FACT_DROPPED;
import constants::FACT_MAX_POSITION;
import constants::FACT_MIN_POSITION;
import constants::FACT_REACH;
import constants::FACT_STRETCHED;
import constants::GEOMETRY_WORDS;
import constants::MASK_WORDS;
import constants::ROW_COLOR;
import constants::ROW_HARMONICS;
import constants::ROW_LOG_SCALE;
import constants::ROW_OPACITY;
import constants::ROW_POSITION;
import constants::ROW_ROTATION;
import constants::SH_BANDS;
import constants::SH_VALUES;
import constants::SH_WORDS;
import layout::IngestParameters;
import package::lib::dispatch::linearWorkgroup;
import package::lib::drop_reason::DROP_REASONS;
import package::lib::drop_reason::NON_FINITE_COLOR;
import package::lib::drop_reason::NON_FINITE_OPACITY;
import package::lib::drop_reason::NON_FINITE_POSITION;
import package::lib::drop_reason::NON_FINITE_ROTATION;
import package::lib::drop_reason::NON_FINITE_SCALE;
import package::lib::drop_reason::SOUND;
import package::lib::exact_exp::exactExp;
import package::lib::float_bits::fromOrderedBits;
import package::lib::float_bits::isEqualBits;
import package::lib::float_bits::isFiniteBits;
import package::lib::float_bits::isNanBits;
import package::lib::float_bits::MAGNITUDE_BITS;
import package::lib::float_bits::NEGATIVE_INFINITY_BITS;
import package::lib::float_bits::orderedBits;
import package::lib::float_bits::TWO_TO_100_BITS;
import package::lib::float_bits::TWO_TO_MINUS_100;
import package::lib::float_bits::TWO_TO_MINUS_60_BITS;
import package::lib::harmonics_packing::byteOf;
import package::lib::harmonics_packing::scaleBitsOf;
import package::lib::harmonics_packing::scaleOf;
import package::lib::pack_splat::halfBits;
import package::lib::pack_splat::logScaleRange;
@if(!GEOMETRY_F32) import package::lib::pack_splat::logScaleSteps;
import package::lib::pack_splat::packRotation;

@group(0) @binding(0) var<uniform> parameters: IngestParameters;
@group(0) @binding(1) var<storage, read> rows: array<u32>;
@group(0) @binding(2) var<storage, read_write> geometry: array<array<u32, GEOMETRY_WORDS>>;
@if(!GEOMETRY_F32) @group(0) @binding(3) var<storage, read_write> logScaleRests: array<u32>;
@if(SH_1) @group(0) @binding(4) var<storage, read_write> harmonics: array<u32>;
@group(0) @binding(5) var<storage, read_write> dropMask: array<u32>;
@group(0) @binding(6) var<storage, read_write> facts: array<atomic<u32>, FACTS>;
@if(ROW_PALETTE) @group(0) @binding(7) var<storage, read> palette: array<u32>;
/// As words, since the bounds' bits are kept.
@group(0) @binding(8) var<storage, read_write> chunks: array<array<u32, 8>>;

var<workgroup> ownFacts: array<atomic<u32>, FACTS>;
/// Largest complement of `orderedBits` of log scales, and their largest, 0 if no row was kept.
var<workgroup> ownLogScales: array<atomic<u32>, 2>;
var<workgroup> ownMask: array<atomic<u32>, MASK_WORDS>;

@compute @workgroup_size(CHUNK_SPLATS)
fn ingestRows(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let first = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_SPLATS;
  let index = first + lane;
  let row = parameters.firstRow + index;
  let slot = parameters.pageSlot + index;
  let isKept = index < parameters.rowCount && isKeptRow(row, lane);
  if (isKept) {
    boundRow(row);
    @if(SH_1) { takeHarmonics(row, slot); }
  }
  workgroupBarrier();
  if (first >= parameters.rowCount) { return; }
  let smallest = bitcast<f32>(fromOrderedBits(~atomicLoad(&ownLogScales[0])));
  let range = logScaleRange(smallest, bitcast<f32>(fromOrderedBits(atomicLoad(&ownLogScales[1]))));
  if (isKept) { takeGeometry(row, slot, range); }
  if (lane == 0u && atomicLoad(&ownLogScales[1]) > 0u) {
    let chunk = &chunks[(parameters.maskRow + first) / CHUNK_SPLATS];
    for (var axis = 0u; axis < 3u; axis++) {
      (*chunk)[axis] = fromOrderedBits(~atomicLoad(&ownFacts[FACT_MIN_POSITION + axis]));
      (*chunk)[4u + axis] = fromOrderedBits(atomicLoad(&ownFacts[FACT_MAX_POSITION + axis]));
    }
    (*chunk)[3] = bitcast<u32>(range.x);
    (*chunk)[7] = bitcast<u32>(range.y);
  }
  if (lane < FACTS) {
    let fact = atomicLoad(&ownFacts[lane]);
    if (isCount(lane)) {
      if (fact > 0u) { atomicAdd(&facts[lane], fact); }
    } else {
      atomicMax(&facts[lane], fact);
    }
  }
  if (lane < MASK_WORDS) {
    dropMask[(parameters.maskRow + first) / 32u + lane] = atomicLoad(&ownMask[lane]);
  }
}

fn isCount(fact: u32) -> bool {
  return fact >= FACT_DROPPED && fact < FACT_DROPPED + DROP_REASONS;
}

/// Counts the row if it is to be dropped.
fn isKeptRow(row: u32, lane: u32) -> bool {
  let reason = reasonToDrop(row);
  if (reason == SOUND) { return true; }
  atomicAdd(&ownFacts[FACT_DROPPED + reason], 1u);
  atomicOr(&ownMask[lane / 32u], 1u << (lane % 32u));
  return false;
}

/// The first reason, or SOUND. Infinite logits mean 0 or 1, a log scale of −∞ a scale of 0.
fn reasonToDrop(row: u32) -> u32 {
  if (!isFinite(row, ROW_POSITION, 3u)) { return NON_FINITE_POSITION; }
  for (var axis = 0u; axis < 3u; axis++) {
    let bits = valueBits(row, ROW_LOG_SCALE + axis);
    if (!isFiniteBits(bits) && bits != NEGATIVE_INFINITY_BITS) { return NON_FINITE_SCALE; }
  }
  if (!isFinite(row, ROW_ROTATION, 4u)) { return NON_FINITE_ROTATION; }
  if (isNanBits(valueBits(row, ROW_OPACITY))) { return NON_FINITE_OPACITY; }
  if (!isFinite(row, ROW_COLOR, 3u + SH_VALUES)) { return NON_FINITE_COLOR; }
  return SOUND;
}

fn isFinite(row: u32, slot: u32, count: u32) -> bool {
  var isFiniteSoFar = true;
  for (var i = 0u; i < count; i++) { isFiniteSoFar &= isFiniteBits(valueBits(row, slot + i)); }
  return isFiniteSoFar;
}

/// Bits of the log scales, clamped to ±40.
fn logScaleBits(row: u32) -> vec3u {
  let bits = valueBits3(row, ROW_LOG_SCALE);
  return (bits & vec3u(~MAGNITUDE_BITS)) | min(bits & vec3u(MAGNITUDE_BITS), vec3u(0x42200000u));
}

fn boundRow(row: u32) {
  let position = valueBits3(row, ROW_POSITION);
  let clampedBits = logScaleBits(row);
  for (var axis = 0u; axis < 3u; axis++) {
    let ordered = orderedBits(position[axis]);
    atomicMax(&ownFacts[FACT_MIN_POSITION + axis], ~ordered);
    atomicMax(&ownFacts[FACT_MAX_POSITION + axis], ordered);
    let orderedScale = orderedBits(clampedBits[axis]);
    atomicMax(&ownLogScales[0], ~orderedScale);
    atomicMax(&ownLogScales[1], orderedScale);
  }
  let scaleBits = valueBits3(row, ROW_LOG_SCALE);
  let isRound = isEqualBits(scaleBits.x, scaleBits.y) && isEqualBits(scaleBits.x, scaleBits.z);
  if (!isRound) { atomicMax(&ownFacts[FACT_STRETCHED], 1u); }
}

/// `range`: least log scale and step of the row's chunk.
fn takeGeometry(row: u32, slot: u32, range: vec2f) {
  let position = valueBits3(row, ROW_POSITION);
  let logScale = bitcast<vec3f>(logScaleBits(row));
  let rotation = normalizedRotation(row);
  let opacity = opacityOf(valueBits(row, ROW_OPACITY));
  writeGeometry(slot, position, logScale, range, rotation, opacity, bitcast<vec3f>(valueBits3(row, ROW_COLOR)));
}

/// 64 bytes, as data/packing/geometry.ts lays them out.
@if(GEOMETRY_F32)
fn writeGeometry(slot: u32, position: vec3u, logScale: vec3f, range: vec2f, rotation: vec4f, opacity: f32, colorDc: vec3f) {
  let color = clamp(colorDc, vec3f(-1e35), vec3f(1e35));
  let scale = vec3f(exactExp(logScale.x), exactExp(logScale.y), exactExp(logScale.z));
  let record = &geometry[slot];
  for (var axis = 0u; axis < 3u; axis++) {
    (*record)[axis] = position[axis];
    (*record)[8u + axis] = bitcast<u32>(scale[axis]);
    (*record)[12u + axis] = bitcast<u32>(color[axis]);
  }
  (*record)[3] = bitcast<u32>(opacity);
  for (var k = 0u; k < 4u; k++) { (*record)[4u + k] = bitcast<u32>(rotation[k]); }
}

/// 32 bytes, as data/packing/geometry.ts lays them out. `logScaleRests` keeps what rounding to a
/// step leaves out: −512…511 parts of 1024, with 512 added.
@if(!GEOMETRY_F32)
fn writeGeometry(slot: u32, position: vec3u, logScale: vec3f, range: vec2f, rotation: vec4f, opacity: f32, colorDc: vec3f) {
  let dc = vec3u(halfBits(colorDc.x), halfBits(colorDc.y), halfBits(colorDc.z));
  let parts = logScaleSteps(logScale, range, 1024.0) + vec3u(512u);
  let steps = parts >> vec3u(10u);
  let turned = packRotation(rotation);
  let record = &geometry[slot];
  for (var axis = 0u; axis < 3u; axis++) { (*record)[axis] = position[axis]; }
  (*record)[3] = dc.x | (dc.y << 16u);
  (*record)[4] = dc.z | (u32(floor(opacity * 65535.0 + 0.5)) << 16u);
  (*record)[5] = steps.x | (steps.y << 16u);
  (*record)[6] = steps.z | (turned.x << 16u);
  (*record)[7] = turned.y;
  let rests = parts & vec3u(0x3ffu);
  logScaleRests[parameters.maskRow + slot - parameters.pageSlot] = rests.x | (rests.y << 10u) | (rests.z << 20u);
}

/// Opacity of a logit; beyond ±87 it is 0 or 1 to float32.
fn opacityOf(logitBits: u32) -> f32 {
  if ((logitBits & MAGNITUDE_BITS) > 0x42ae0000u) { return select(1.0, 0.0, (logitBits >> 31u) == 1u); }
  return 1.0 / (1.0 + exactExp(-bitcast<f32>(logitBits)));
}

/// Unit quaternion; the identity if all four values are zero.
fn normalizedRotation(row: u32) -> vec4f {
  let bits = vec4u(
    valueBits(row, ROW_ROTATION),
    valueBits(row, ROW_ROTATION + 1u),
    valueBits(row, ROW_ROTATION + 2u),
    valueBits(row, ROW_ROTATION + 3u),
  );
  let size = bits & vec4u(MAGNITUDE_BITS);
  let largest = max(max(size.x, size.y), max(size.z, size.w));
  if (largest == 0u) { return vec4f(1.0, 0.0, 0.0, 0.0); }
  // Scaled first, so that neither 1e-20 nor 1e20 leaves the range when squared.
  let values = vec4f(
    inRange(bits.x, largest),
    inRange(bits.y, largest),
    inRange(bits.z, largest),
    inRange(bits.w, largest),
  );
  let scaled = values / max(max(abs(values.x), abs(values.y)), max(abs(values.z), abs(values.w)));
  return scaled / sqrt(dot(scaled, scaled));
}

/// The float of these bits; times 2¹⁴⁹ if `largest`, the magnitude of the largest beside it, is
/// below 2⁻⁶⁰, so that no subnormal number takes part; times 2⁻¹⁰⁰ from 2¹⁰⁰ on, since devices may
/// divide by numbers beyond 2¹²⁶ as by infinity.
fn inRange(bits: u32, largest: u32) -> f32 {
  if (largest >= TWO_TO_100_BITS) { return bitcast<f32>(bits) * TWO_TO_MINUS_100; }
  if (largest >= TWO_TO_MINUS_60_BITS) { return bitcast<f32>(bits); }
  let size = bits & MAGNITUDE_BITS;
  // A subnormal number has its mantissa's value times 2⁻¹⁴⁹.
  let raised = select(bitcast<f32>(size + (149u << 23u)), f32(size), size < 0x800000u);
  return select(raised, -raised, (bits >> 31u) == 1u);
}

@if(SH_1)
fn takeHarmonics(row: u32, slot: u32) {
  for (var band = 0u; band < SH_BANDS; band++) {
    var squares = vec3f(0.0);
    // Coefficients of lower bands, three channels each, precede this band.
    let first = ROW_HARMONICS + 3u * ((band + 1u) * (band + 1u) - 1u);
    let count = 2u * band + 3u;
    for (var i = 0u; i < count; i++) {
      // Up to where squares stay in range, and far beyond any difference.
      let value = min(abs(bitcast<vec3f>(valueBits3(row, first + 3u * i))), vec3f(1e18));
      squares += value * value;
    }
    let largest = max(squares.x, max(squares.y, squares.z));
    atomicMax(&ownFacts[FACT_REACH + band], bitcast<u32>(largest));
  }
  writeHarmonics(row, slot * SH_WORDS);
}

@if(SH_1 && SH_F32)
fn writeHarmonics(row: u32, at: u32) {
  for (var i = 0u; i < SH_VALUES; i++) {
    let bits = valueBits(row, ROW_HARMONICS + i);
    // 1e35, where sums of coefficients stay in range.
    let size = min(bits & MAGNITUDE_BITS, 0x799a130cu);
    harmonics[at + i] = size | (bits & 0x80000000u);
  }
}

@if(SH_1 && SH_F16)
fn writeHarmonics(row: u32, at: u32) {
  for (var word = 0u; word < SH_WORDS; word++) {
    var bits = halfBits(coefficient(row, 2u * word));
    if (2u * word + 1u < SH_VALUES) { bits |= halfBits(coefficient(row, 2u * word + 1u)) << 16u; }
    harmonics[at + word] = bits;
  }
}

@if(SH_1 && SH_U8)
fn writeHarmonics(row: u32, at: u32) {
  var largest = 0.0;
  for (var i = 0u; i < SH_VALUES; i++) { largest = max(largest, abs(coefficient(row, i))); }
  let scaleBits = scaleBitsOf(largest);
  let scale = scaleOf(scaleBits);
  for (var word = 0u; word < SH_WORDS; word++) {
    var bits = select(0u, scaleBits, word == 0u);
    for (var part = 0u; part < 4u; part++) {
      let place = 4u * word + part;
      if (place >= 2u && place < SH_VALUES + 2u) {
        bits = insertBits(bits, byteOf(coefficient(row, place - 2u), scale), 8u * part, 8u);
      }
    }
    harmonics[at + word] = bits;
  }
}

@if(SH_1)
fn coefficient(row: u32, i: u32) -> f32 {
  return bitcast<f32>(valueBits(row, ROW_HARMONICS + i));
}

fn valueBits3(row: u32, slot: u32) -> vec3u {
  return vec3u(valueBits(row, slot), valueBits(row, slot + 1u), valueBits(row, slot + 2u));
}

@if(!ROW_PALETTE && !ROW_BYTE_HARMONICS)
fn valueBits(row: u32, slot: u32) -> u32 {
  return ownBits(row, slot);
}

/// Harmonics come from an entry of the palette, whose index is the row's last value.
@if(ROW_PALETTE)
fn valueBits(row: u32, slot: u32) -> u32 {
  if (slot < ROW_HARMONICS) { return ownBits(row, slot); }
  let entry = u32(bitcast<f32>(ownBits(row, ROW_HARMONICS)));
  return palette[entry * ENTRY_VALUES + slot - ROW_HARMONICS];
}

/// Harmonics are bytes: see `ByteValues` of data/packing/row-layout.ts. Nothing is rounded.
@if(ROW_BYTE_HARMONICS)
fn valueBits(row: u32, slot: u32) -> u32 {
  if (slot < ROW_HARMONICS) { return ownBits(row, slot); }
  let at = parameters.harmonicsByte + row * parameters.harmonicsStrideBytes + offsetOf(slot);
  let byte = extractBits(rows[at / 4u], 8u * (at % 4u), 8u);
  let values = parameters.byteValues;
  let value = f32(byte) * values.x + values.y;
  return bitcast<u32>(select(select(value, values.w, byte == 255u), values.z, byte == 0u));
}

/// The four bytes of a value, which may begin anywhere, in the order of this machine.
fn ownBits(row: u32, slot: u32) -> u32 {
  let at = row * parameters.strideBytes + offsetOf(slot);
  let shift = 8u * (at % 4u);
  var bits = rows[at / 4u];
  if (shift > 0u) { bits = (bits >> shift) | (rows[at / 4u + 1u] << (32u - shift)); }
  let swapped = (bits << 24u) | ((bits & 0xff00u) << 8u) | ((bits >> 8u) & 0xff00u) | (bits >> 24u);
  return select(bits, swapped, parameters.isBigEndian == 1u);
}

fn offsetOf(slot: u32) -> u32 {
  return parameters.offsets[slot / 4u][slot % 4u];
}
