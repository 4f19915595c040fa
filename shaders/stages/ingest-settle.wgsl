// Gives the splats of a page their place about the cloud's origin and their log scales in steps of the cloud's range, once
// both are known. Changes packed geometry from ingest-rows in place. One thread per slot.
import constants::CHUNK_SPLATS;
import constants::GEOMETRY_WORDS;
import layout::SettleParameters;
import package::lib::dispatch::linearWorkgroup;

@group(0) @binding(0) var<uniform> parameters: SettleParameters;
@group(0) @binding(1) var<storage, read_write> geometry: array<array<u32, GEOMETRY_WORDS>>;
@if(!GEOMETRY_F32) @group(0) @binding(2) var<storage, read> logScaleRests: array<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn ingestSettle(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let slot = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_SPLATS + lane;
  if (slot >= parameters.slotCount) { return; }
  for (var axis = 0u; axis < 3u; axis++) {
    // Otherwise the file's bits stay, subnormal ones too.
    if (parameters.origin[axis] != 0.0) {
      geometry[slot][axis] = bitcast<u32>(bitcast<f32>(geometry[slot][axis]) - parameters.origin[axis]);
    }
  }
  @if(!GEOMETRY_F32) { settleLogScales(slot); }
}

@if(!GEOMETRY_F32)
fn settleLogScales(slot: u32) {
  let first = geometry[slot][5];
  let second = geometry[slot][6];
  let rests = logScaleRests[parameters.firstSlot + slot];
  let x = settled(first & 0xffffu, rests);
  let y = settled(first >> 16u, rests >> 10u);
  let z = settled(second & 0xffffu, rests >> 20u);
  geometry[slot][5] = x | (y << 16u);
  geometry[slot][6] = z | (second & 0xffff0000u);
}

/// Steps of the cloud's range, from steps of 2⁻¹⁹ in two parts.
@if(!GEOMETRY_F32)
fn settled(upper: u32, rest: u32) -> u32 {
  if (parameters.logScaleStep == 0.0) { return 0u; }
  let steps = (upper << 10u) | (rest & 0x3ffu);
  // Slots of dropped rows are below the smallest.
  let above = f32(max(steps, parameters.minLogScale) - parameters.minLogScale) / 524288.0;
  return u32(clamp(floor(above / parameters.logScaleStep + 0.5), 0.0, 65535.0));
}
