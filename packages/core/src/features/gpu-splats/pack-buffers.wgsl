// Packs splats that the application's own GPU work has written into its buffers. Reads a column of
// float32 values per property, each with a first word and a stride; writes a page of geometry and the
// bounds of its chunks. One workgroup per chunk, one thread per splat. Values are tested as bits.
// Splats that cannot be drawn get an opacity of 0, and take no part in bounds.
import constants::CHUNK_SPLATS;
@if(COUNTS_FAULTS) import constants::FAULTS;
import layout::BufferParameters;
import package::lib::dispatch::linearWorkgroup;
import package::lib::drop_reason::NON_FINITE_COLOR;
@if(OPACITIES) import package::lib::drop_reason::NON_FINITE_OPACITY;
import package::lib::drop_reason::NON_FINITE_POSITION;
@if(ROTATIONS) import package::lib::drop_reason::NON_FINITE_ROTATION;
import package::lib::drop_reason::NON_FINITE_SCALE;
import package::lib::drop_reason::OUT_OF_BOUNDS;
import package::lib::drop_reason::SOUND;
import package::lib::float_bits::fromOrderedBits;
import package::lib::float_bits::isFiniteBits;
import package::lib::float_bits::orderedBits;
@if(ROTATIONS) import package::lib::float_bits::TWO_TO_100;
@if(ROTATIONS) import package::lib::float_bits::TWO_TO_MINUS_100;
import package::lib::pack_splat::logScaleRange;
@if(!GEOMETRY_F32) import package::lib::pack_splat::packSplat;
@if(GEOMETRY_F32) import package::lib::pack_splat::storeSplat;
import package::lib::packing::GEOMETRY_VECTORS;
import package::lib::packing::Splat;

@group(0) @binding(0) var<uniform> parameters: BufferParameters;
@group(0) @binding(1) var<storage, read> positions: array<u32>;
@group(0) @binding(2) var<storage, read> scales: array<u32>;
@if(ROTATIONS) @group(0) @binding(3) var<storage, read> rotations: array<u32>;
@if(OPACITIES) @group(0) @binding(4) var<storage, read> opacities: array<u32>;
@group(0) @binding(5) var<storage, read> colors: array<u32>;
@group(0) @binding(6) var<storage, read_write> geometry: array<array<vec4u, GEOMETRY_VECTORS>>;
/// As words, since the bounds' bits are kept.
@group(0) @binding(7) var<storage, read_write> chunks: array<array<u32, 8>>;
/// Splats by their first fault, in the order of `GPU_FAULTS`.
@if(COUNTS_FAULTS) @group(0) @binding(8) var<storage, read_write> faults: array<atomic<u32>, FAULTS>;

/// e^−40 and e^40, as scales of files are clamped.
const LEAST_SCALE = 4.248354e-18;
const MOST_SCALE = 2.3538526e17;
/// Log scale of a chunk without splats to draw, far below any other.
const NO_LOG_SCALE = -1000.0;
/// Coefficient of degree 0 per unit of colour, √(4π).
const COEFFICIENT = 3.544907701811032;

/// Largest complements of `orderedBits`, and largest `orderedBits`: positions, then log scales.
var<workgroup> least: array<atomic<u32>, 4>;
var<workgroup> largest: array<atomic<u32>, 4>;

@compute @workgroup_size(CHUNK_SPLATS)
fn packBuffers(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let chunk = linearWorkgroup(workgroup, parameters.dispatchRow);
  let index = chunk * CHUNK_SPLATS + lane;
  let isSplat = index < parameters.splatCount;
  var splat = Splat(nowhere(), 0.0, vec4f(1.0, 0.0, 0.0, 0.0), vec3f(1.0), vec3f(0.0));
  if (isSplat) {
    let fault = faultOf(index);
    @if(COUNTS_FAULTS) if (fault != SOUND) { atomicAdd(&faults[fault], 1u); }
    let opacity = opacityOf(index);
    if (fault == SOUND && opacity > 0.0) {
      splat = splatAt(index, opacity);
      for (var axis = 0u; axis < 3u; axis++) {
        widen(axis, positions[wordOf(index, 0u) + axis]);
        widen(3u, bitcast<u32>(log(splat.scale[axis])));
      }
    }
  }
  workgroupBarrier();
  if (!isSplat) { return; }
  let isEmpty = atomicLoad(&largest[3]) == 0u;
  let smallest = bitcast<f32>(fromOrderedBits(~atomicLoad(&least[3])));
  let found = logScaleRange(smallest, bitcast<f32>(fromOrderedBits(atomicLoad(&largest[3]))));
  let range = select(found, vec2f(NO_LOG_SCALE, 0.0), isEmpty);
  @if(GEOMETRY_F32) { geometry[index] = storeSplat(splat); }
  @if(!GEOMETRY_F32) { geometry[index] = packSplat(splat, range); }
  if (lane > 0u) { return; }
  let place = bitcast<vec3u>(nowhere());
  for (var axis = 0u; axis < 3u; axis++) {
    chunks[chunk][axis] = select(fromOrderedBits(~atomicLoad(&least[axis])), place[axis], isEmpty);
    chunks[chunk][4u + axis] = select(fromOrderedBits(atomicLoad(&largest[axis])), place[axis], isEmpty);
  }
  chunks[chunk][3] = bitcast<u32>(range.x);
  chunks[chunk][7] = bitcast<u32>(range.y);
}

/// Place of splats that are not drawn, within the cloud's bounds.
fn nowhere() -> vec3f {
  return clamp(vec3f(0.0), parameters.boundsMin, parameters.boundsMax);
}

fn widen(bound: u32, bits: u32) {
  let ordered = orderedBits(bits);
  atomicMax(&least[bound], ~ordered);
  atomicMax(&largest[bound], ordered);
}

/// First word of a splat in column `column`: positions, scales, rotations, opacities, colours.
fn wordOf(index: u32, column: u32) -> u32 {
  let place = parameters.columns[column];
  return place.x + index * place.y;
}

/// Why a splat cannot be drawn; `SOUND` if it can.
fn faultOf(index: u32) -> u32 {
  let position = bitsOf3(index, 0u);
  if (!areFinite(position)) { return NON_FINITE_POSITION; }
  if (!areFinite(bitsOf3(index, 1u))) { return NON_FINITE_SCALE; }
  @if(ROTATIONS) let rotation = rotationBits(index);
  @if(ROTATIONS) if (!areFinite(rotation.xyz) || !isFiniteBits(rotation.w)) { return NON_FINITE_ROTATION; }
  @if(OPACITIES) if (!isFiniteBits(opacities[wordOf(index, 3u)])) { return NON_FINITE_OPACITY; }
  if (!areFinite(bitsOf3(index, 4u))) { return NON_FINITE_COLOR; }
  let place = bitcast<vec3f>(position);
  if (any(place < parameters.boundsMin) || any(place > parameters.boundsMax)) { return OUT_OF_BOUNDS; }
  return SOUND;
}

fn areFinite(bits: vec3u) -> bool {
  return isFiniteBits(bits.x) && isFiniteBits(bits.y) && isFiniteBits(bits.z);
}

fn bitsOf3(index: u32, column: u32) -> vec3u {
  let word = wordOf(index, column);
  if (column == 0u) { return vec3u(positions[word], positions[word + 1u], positions[word + 2u]); }
  if (column == 1u) { return vec3u(scales[word], scales[word + 1u], scales[word + 2u]); }
  return vec3u(colors[word], colors[word + 1u], colors[word + 2u]);
}

/// 0…1; 0 for a value that is not finite.
fn opacityOf(index: u32) -> f32 {
  @if(!OPACITIES) return 1.0;
  @if(OPACITIES) let bits = opacities[wordOf(index, 3u)];
  @if(OPACITIES) if (!isFiniteBits(bits)) { return 0.0; }
  @if(OPACITIES) return clamp(bitcast<f32>(bits), 0.0, 1.0);
}

/// A splat without faults.
fn splatAt(index: u32, opacity: f32) -> Splat {
  let color = clamp(bitcast<vec3f>(bitsOf3(index, 4u)), vec3f(-1e34), vec3f(1e34));
  return Splat(
    bitcast<vec3f>(bitsOf3(index, 0u)),
    opacity,
    rotationOf(index),
    clamp(abs(bitcast<vec3f>(bitsOf3(index, 1u))), vec3f(LEAST_SCALE), vec3f(MOST_SCALE)),
    (color - 0.5) * COEFFICIENT,
  );
}

@if(!ROTATIONS)
fn rotationOf(index: u32) -> vec4f {
  return vec4f(1.0, 0.0, 0.0, 0.0);
}

/// Unit quaternion w, x, y, z; the identity for lengths below 1e-30.
@if(ROTATIONS)
fn rotationOf(index: u32) -> vec4f {
  let given = bitcast<vec4f>(rotationBits(index)).wxyz;
  // Scaled first: devices may divide by numbers beyond 2¹²⁶ as by infinity.
  let values = select(given, given * TWO_TO_MINUS_100, sizeOf(given) > TWO_TO_100);
  let size = sizeOf(values);
  if (!(size > 1e-30)) { return vec4f(1.0, 0.0, 0.0, 0.0); }
  return normalize(values / size);
}

@if(ROTATIONS)
fn sizeOf(values: vec4f) -> f32 {
  let size = abs(values);
  return max(max(size.x, size.y), max(size.z, size.w));
}

/// x, y, z, w.
@if(ROTATIONS)
fn rotationBits(index: u32) -> vec4u {
  let word = wordOf(index, 2u);
  return vec4u(rotations[word], rotations[word + 1u], rotations[word + 2u], rotations[word + 3u]);
}
