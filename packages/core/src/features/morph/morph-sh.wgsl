// Blends two pages of spherical harmonics above degree 0 linearly, splat by splat. Reads both and
// writes a third page, all stored alike, as data/packing/harmonics.ts does. One thread per splat.
import constants::CHUNK_SPLATS;
import constants::SH_VALUES;
import constants::SH_WORDS;
import layout::MorphParameters;
import package::lib::dispatch::linearWorkgroup;
import package::lib::harmonics_packing::byteOf;
import package::lib::harmonics_packing::scaleBitsOf;
import package::lib::harmonics_packing::scaleOf;
import package::lib::pack_splat::halfBits;

@group(0) @binding(0) var<uniform> parameters: MorphParameters;
@group(0) @binding(1) var<storage, read> first: array<u32>;
@group(0) @binding(2) var<storage, read> second: array<u32>;
@group(0) @binding(3) var<storage, read_write> morphed: array<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn morphSh(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_SPLATS + lane;
  if (index >= parameters.splatCount) { return; }
  writeSplat(index * SH_WORDS);
}

@if(SH_F32)
fn writeSplat(at: u32) {
  for (var i = 0u; i < SH_VALUES; i++) { morphed[at + i] = bitcast<u32>(coefficient(at, i)); }
}

/// Writes two coefficients per word, low half first.
@if(SH_F16)
fn writeSplat(at: u32) {
  for (var word = 0u; word < SH_WORDS; word++) {
    var bits = halfBits(coefficient(at, 2u * word));
    if (2u * word + 1u < SH_VALUES) { bits |= halfBits(coefficient(at, 2u * word + 1u)) << 16u; }
    morphed[at + word] = bits;
  }
}

/// Writes the splat's scale as binary16, then a signed byte per coefficient.
@if(SH_U8)
fn writeSplat(at: u32) {
  var largest = 0.0;
  for (var i = 0u; i < SH_VALUES; i++) { largest = max(largest, abs(coefficient(at, i))); }
  let scaleBits = scaleBitsOf(largest);
  let scale = scaleOf(scaleBits);
  for (var word = 0u; word < SH_WORDS; word++) {
    var bits = select(0u, scaleBits, word == 0u);
    for (var part = 0u; part < 4u; part++) {
      let place = 4u * word + part;
      if (place >= 2u && place < SH_VALUES + 2u) {
        bits = insertBits(bits, byteOf(coefficient(at, place - 2u), scale), 8u * part, 8u);
      }
    }
    morphed[at + word] = bits;
  }
}

/// Coefficient `i`, blended, of the splat whose words start at `at`.
fn coefficient(at: u32, i: u32) -> f32 {
  let word = at + wordOf(i);
  let a = valueIn(first[at], first[word], i);
  let b = valueIn(second[at], second[word], i);
  return a * (1.0 - parameters.amount) + b * parameters.amount;
}

/// Word of a splat that holds its coefficient `i`.
fn wordOf(i: u32) -> u32 {
  @if(SH_F32) return i;
  @if(SH_F16) return i / 2u;
  @if(SH_U8) return (i + 2u) / 4u;
}

/// Coefficient `i` in its word; `head` is the first word of the splat.
fn valueIn(head: u32, word: u32, i: u32) -> f32 {
  @if(SH_F32) return bitcast<f32>(word);
  @if(SH_F16) return unpack2x16float(word >> (16u * (i % 2u))).x;
  @if(SH_U8) let byte = extractBits(bitcast<i32>(word), 8u * ((i + 2u) % 4u), 8u);
  @if(SH_U8) return f32(byte) / 127.0 * unpack2x16float(head).x;
}
