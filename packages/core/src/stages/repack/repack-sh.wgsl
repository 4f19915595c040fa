// Packs a page of spherical harmonics above degree 0 more coarsely, as data/packing/harmonics.ts
// does. Reads f32 or f16 coefficients; writes f16 or u8 ones. One thread per splat. Runs on the
// GPU, which already holds the finer plane, so that nothing is read back.
import constants::COARSER_WORDS;
import constants::FINER_WORDS;
import constants::CHUNK_SPLATS;
import constants::SH_VALUES;
import layout::RepackParameters;
import package::lib::dispatch::linearWorkgroup;
import package::lib::harmonics_packing::byteOf;
import package::lib::harmonics_packing::scaleBitsOf;
import package::lib::harmonics_packing::scaleOf;
import package::lib::pack_splat::halfBits;

@group(0) @binding(0) var<uniform> parameters: RepackParameters;
@group(0) @binding(1) var<storage, read> finer: array<u32>;
@group(0) @binding(2) var<storage, read_write> coarser: array<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn repackSh(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_SPLATS + lane;
  if (index >= parameters.splatCount) { return; }
  writeSplat(index * FINER_WORDS, index * COARSER_WORDS);
}

/// Writes two coefficients per word, low half first.
@if(!REPACK_TO_U8)
fn writeSplat(first: u32, at: u32) {
  for (var word = 0u; word < COARSER_WORDS; word++) {
    var bits = halfBits(finerValue(first, 2u * word));
    if (2u * word + 1u < SH_VALUES) { bits |= halfBits(finerValue(first, 2u * word + 1u)) << 16u; }
    coarser[at + word] = bits;
  }
}

/// Writes the splat's scale as binary16, then a signed byte per coefficient.
@if(REPACK_TO_U8)
fn writeSplat(first: u32, at: u32) {
  var largest = 0.0;
  for (var i = 0u; i < SH_VALUES; i++) { largest = max(largest, abs(finerValue(first, i))); }
  let scaleBits = scaleBitsOf(largest);
  let scale = scaleOf(scaleBits);
  for (var word = 0u; word < COARSER_WORDS; word++) {
    var bits = select(0u, scaleBits, word == 0u);
    for (var part = 0u; part < 4u; part++) {
      let place = 4u * word + part;
      if (place >= 2u && place < SH_VALUES + 2u) {
        bits = insertBits(bits, byteOf(finerValue(first, place - 2u), scale), 8u * part, 8u);
      }
    }
    coarser[at + word] = bits;
  }
}

@if(SH_F32)
fn finerValue(first: u32, i: u32) -> f32 {
  return bitcast<f32>(finer[first + i]);
}

@if(SH_F16)
fn finerValue(first: u32, i: u32) -> f32 {
  return unpack2x16float(finer[first + i / 2u] >> (16u * (i % 2u))).x;
}
