// Makes sort keys for the storage order: 48-bit Morton codes, eight bits in each of six rounds.
// Reads the positions of a page; writes keys and payloads (slots) of its splats. One thread per
// place in the order so far.
import constants::CHUNK_SPLATS;
import constants::GEOMETRY_WORDS;
import layout::MortonParameters;
import package::lib::dispatch::linearWorkgroup;
import package::lib::float_bits::aboutOrigin;
import package::lib::float_bits::MAGNITUDE_BITS;

@group(0) @binding(0) var<uniform> parameters: MortonParameters;
@group(0) @binding(1) var<storage, read> geometry: array<array<u32, GEOMETRY_WORDS>>;
@group(0) @binding(2) var<storage, read> dropMask: array<u32>;
@group(0) @binding(3) var<storage, read> order: array<u32>;
@group(0) @binding(4) var<storage, read_write> keys: array<u32>;
@group(0) @binding(5) var<storage, read_write> payloads: array<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn ingestKeys(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let place = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_SPLATS + lane;
  if (place >= parameters.slotCount) { return; }
  var slot = place;
  if (parameters.round > 0u) { slot = order[place]; }
  if (slot < parameters.pageStart || slot >= parameters.pageEnd) { return; }
  let record = slot - parameters.pageStart;
  let cells = vec3u(cell(record, 0u), cell(record, 1u), cell(record, 2u)) >> vec3u(8u * (parameters.round / 3u));
  let code = spread(cells.x) | (spread(cells.y) << 1u) | (spread(cells.z) << 2u);
  var key = (code >> (8u * (parameters.round % 3u))) & 0xffu;
  // Dropped rows go behind all others.
  let isDropped = (dropMask[slot / 32u] >> (slot % 32u)) & 1u;
  if (parameters.round == 5u) { key |= isDropped << 8u; }
  keys[place] = key;
  payloads[place] = slot;
}

/// As mortonCell of data/packing/morton-order.ts, with the same roundings.
fn cell(record: u32, axis: u32) -> u32 {
  let bits = aboutOrigin(geometry[record][axis], parameters.origin[axis]);
  let coordinate = select(bitcast<f32>(bits), 0.0, (bits & MAGNITUDE_BITS) < 0x800000u);
  let scaled = clamp(coordinate, parameters.min[axis], parameters.max[axis]) * parameters.scale[axis];
  return u32(clamp((scaled - parameters.scaledMin[axis]) * parameters.cellsPerUnit, 0.0, 65535.0));
}

/// The lowest eight bits of `value` with two zeros between each.
fn spread(value: u32) -> u32 {
  var bits = value & 0xffu;
  bits = (bits | (bits << 8u)) & 0x00f00fu;
  bits = (bits | (bits << 4u)) & 0x0c30c3u;
  return (bits | (bits << 2u)) & 0x249249u;
}
