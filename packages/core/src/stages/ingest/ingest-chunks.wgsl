// Takes the bounds of each chunk of a page once its splats are in storage order, and gives these
// their places about the cloud's origin and their packed log scales in steps of the chunk's range.
// Reads geometry that has been put in order, and log scales to a 1024th of a step as ingest-rows
// has left them in the order of the file; changes geometry in place and writes `Chunk` structs. One
// workgroup per chunk, one thread per splat.
import constants::CHUNK_SPLATS;
import constants::GEOMETRY_WORDS;
@if(!GEOMETRY_F32) import layout::Chunk;
import layout::ChunkParameters;
import package::lib::dispatch::linearWorkgroup;
import package::lib::float_bits::aboutOrigin;
import package::lib::float_bits::fromOrderedBits;
import package::lib::float_bits::orderedBits;
import package::lib::pack_splat::logScaleRange;
@if(!GEOMETRY_F32) import package::lib::pack_splat::logScaleSteps;

@group(0) @binding(0) var<uniform> parameters: ChunkParameters;
@group(0) @binding(1) var<storage, read_write> geometry: array<array<u32, GEOMETRY_WORDS>>;
/// As words, since the bounds' bits are kept.
@group(0) @binding(2) var<storage, read_write> chunks: array<array<u32, 8>>;
@if(!GEOMETRY_F32) @group(0) @binding(3) var<storage, read> fileRows: array<u32>;
@if(!GEOMETRY_F32) @group(0) @binding(4) var<storage, read> arrivedChunks: array<Chunk>;
@if(!GEOMETRY_F32) @group(0) @binding(5) var<storage, read> logScaleRests: array<u32>;

/// Largest complements of `orderedBits`, and largest `orderedBits`: positions, then log scales.
var<workgroup> least: array<atomic<u32>, 4>;
var<workgroup> largest: array<atomic<u32>, 4>;

@compute @workgroup_size(CHUNK_SPLATS)
fn ingestChunks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let chunk = linearWorkgroup(workgroup, parameters.dispatchRow);
  let splat = chunk * CHUNK_SPLATS + lane;
  let isSplat = splat < parameters.splatCount;
  var logScale = vec3f(0.0);
  if (isSplat) {
    logScale = logScaleOf(splat);
    for (var axis = 0u; axis < 3u; axis++) {
      let bits = aboutOrigin(geometry[splat][axis], parameters.origin[axis]);
      geometry[splat][axis] = bits;
      widen(axis, bits);
      widen(3u, bitcast<u32>(logScale[axis]));
    }
  }
  workgroupBarrier();
  if (!isSplat) { return; }
  let smallest = bitcast<f32>(fromOrderedBits(~atomicLoad(&least[3])));
  let range = logScaleRange(smallest, bitcast<f32>(fromOrderedBits(atomicLoad(&largest[3]))));
  @if(!GEOMETRY_F32) let steps = logScaleSteps(logScale, range, 1.0);
  @if(!GEOMETRY_F32) { geometry[splat][5] = steps.x | (steps.y << 16u); }
  @if(!GEOMETRY_F32) { geometry[splat][6] = steps.z | (geometry[splat][6] & 0xffff0000u); }
  if (lane > 0u) { return; }
  for (var axis = 0u; axis < 3u; axis++) {
    chunks[chunk][axis] = fromOrderedBits(~atomicLoad(&least[axis]));
    chunks[chunk][4u + axis] = fromOrderedBits(atomicLoad(&largest[axis]));
  }
  chunks[chunk][3] = bitcast<u32>(range.x);
  chunks[chunk][7] = bitcast<u32>(range.y);
}

fn widen(bound: u32, bits: u32) {
  let ordered = orderedBits(bits);
  atomicMax(&least[bound], ~ordered);
  atomicMax(&largest[bound], ordered);
}

@if(GEOMETRY_F32)
fn logScaleOf(splat: u32) -> vec3f {
  let scale = vec3u(geometry[splat][8], geometry[splat][9], geometry[splat][10]);
  return clamp(log(bitcast<vec3f>(scale)), vec3f(-40.0), vec3f(40.0));
}

/// Log scales from the steps and rests of the chunk that the splat had in the file's order.
@if(!GEOMETRY_F32)
fn logScaleOf(splat: u32) -> vec3f {
  let row = fileRows[parameters.firstSplat + splat];
  let arrived = &arrivedChunks[row / CHUNK_SPLATS];
  let first = geometry[splat][5];
  let steps = vec3u(first & 0xffffu, first >> 16u, geometry[splat][6] & 0xffffu);
  let rests = (vec3u(logScaleRests[row]) >> vec3u(0u, 10u, 20u)) & vec3u(0x3ffu);
  let parts = vec3f(steps) + (vec3f(rests) - 512.0) / 1024.0;
  return (*arrived).minLogScale + (*arrived).logScaleStep * parts;
}
