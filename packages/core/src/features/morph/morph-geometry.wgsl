// Blends two pages of geometry, splat by splat: positions, opacities and base colours linearly,
// sizes geometrically, rotations along the shorter arc. Reads both and writes a third page, all
// stored alike: packed log scales have the ranges of the chunks, which hold both pages' ranges. At 0
// and 1 it copies, since logarithms and packing again may be a step off. One thread per splat.
import constants::CHUNK_SPLATS;
import layout::Chunk;
import layout::MorphParameters;
import package::lib::dispatch::linearWorkgroup;
@if(!GEOMETRY_F32) import package::lib::pack_splat::packSplat;
@if(GEOMETRY_F32) import package::lib::pack_splat::storeSplat;
import package::lib::packing::GEOMETRY_VECTORS;
import package::lib::packing::Splat;
import package::lib::packing::unpackSplat;

@group(0) @binding(0) var<uniform> parameters: MorphParameters;
@group(0) @binding(1) var<storage, read> first: array<array<vec4u, GEOMETRY_VECTORS>>;
@group(0) @binding(2) var<storage, read> second: array<array<vec4u, GEOMETRY_VECTORS>>;
@group(0) @binding(3) var<storage, read_write> morphed: array<array<vec4u, GEOMETRY_VECTORS>>;
@if(!GEOMETRY_F32) @group(0) @binding(4) var<storage, read> chunks: array<Chunk>;

@compute @workgroup_size(CHUNK_SPLATS)
fn morphGeometry(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let index = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_SPLATS + lane;
  if (index >= parameters.splatCount) { return; }
  if (parameters.amount == 0.0) {
    morphed[index] = first[index];
    return;
  }
  if (parameters.amount == 1.0) {
    morphed[index] = second[index];
    return;
  }
  @if(GEOMETRY_F32) morphed[index] = storeSplat(morphSplat(unpackSplat(first[index]), unpackSplat(second[index])));
  @if(!GEOMETRY_F32) let chunk = &chunks[index / CHUNK_SPLATS];
  @if(!GEOMETRY_F32) let range = vec2f((*chunk).minLogScale, (*chunk).logScaleStep);
  @if(!GEOMETRY_F32) let splat = morphSplat(unpackSplat(first[index], range), unpackSplat(second[index], range));
  @if(!GEOMETRY_F32) morphed[index] = packSplat(splat, range);
}

fn morphSplat(a: Splat, b: Splat) -> Splat {
  // The same splat has the same rotation with either sign.
  let facing = select(b.rotation, -b.rotation, dot(a.rotation, b.rotation) < 0.0);
  let position = blend3(a.position, b.position);
  return Splat(
    // Rounding must not move it out of the bounds of its chunk.
    clamp(position, min(a.position, b.position), max(a.position, b.position)),
    blend3(vec3f(a.opacity), vec3f(b.opacity)).x,
    normalize(a.rotation * (1.0 - parameters.amount) + facing * parameters.amount),
    exp(blend3(logOf(a.scale), logOf(b.scale))),
    blend3(a.colorDc, b.colorDc),
  );
}

/// A size that float32 has as 0 has no logarithm: times 0 it would be NaN.
fn logOf(scale: vec3f) -> vec3f {
  return log(max(scale, vec3f(1e-37)));
}

fn blend3(a: vec3f, b: vec3f) -> vec3f {
  return a * (1.0 - parameters.amount) + b * parameters.amount;
}
