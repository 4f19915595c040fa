// Takes the bounds of each chunk of a page. Reads geometry; writes `Chunk` structs. One workgroup per chunk.
import constants::CHUNK_SPLATS;
import constants::GEOMETRY_WORDS;
import layout::Chunk;
import layout::ChunkParameters;
import package::lib::dispatch::linearWorkgroup;
import package::lib::exact_exp::exactExp;
import package::lib::float_bits::orderedBits;

@group(0) @binding(0) var<uniform> parameters: ChunkParameters;
@group(0) @binding(1) var<storage, read> geometry: array<array<u32, GEOMETRY_WORDS>>;
/// As words, since the bounds' bits are kept.
@group(0) @binding(2) var<storage, read_write> chunks: array<array<u32, 8>>;

/// Largest complements of `orderedBits`, largest `orderedBits`, and the largest scale.
var<workgroup> least: array<atomic<u32>, 3>;
var<workgroup> largest: array<atomic<u32>, 3>;
var<workgroup> largestSize: atomic<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn ingestChunks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let chunk = linearWorkgroup(workgroup, parameters.dispatchRow);
  let splat = chunk * CHUNK_SPLATS + lane;
  if (splat < parameters.splatCount) {
    for (var axis = 0u; axis < 3u; axis++) {
      let ordered = orderedBits(geometry[splat][axis]);
      atomicMax(&least[axis], ~ordered);
      atomicMax(&largest[axis], ordered);
    }
    atomicMax(&largestSize, sizeBits(splat));
  }
  workgroupBarrier();
  if (lane > 0u || chunk * CHUNK_SPLATS >= parameters.splatCount) { return; }
  for (var axis = 0u; axis < 3u; axis++) {
    chunks[chunk][axis] = fromOrderedBits(~atomicLoad(&least[axis]));
    chunks[chunk][4u + axis] = fromOrderedBits(atomicLoad(&largest[axis]));
  }
  chunks[chunk][3] = bitcast<u32>(1.001 * scaleOfSize(atomicLoad(&largestSize)));
  chunks[chunk][7] = 0u;
}

fn fromOrderedBits(ordered: u32) -> u32 {
  return select(~ordered, ordered & 0x7fffffffu, (ordered >> 31u) == 1u);
}

/// Grows with the splat's largest scale.
@if(GEOMETRY_F32)
fn sizeBits(splat: u32) -> u32 {
  return max(geometry[splat][8], max(geometry[splat][9], geometry[splat][10]));
}

@if(GEOMETRY_F32)
fn scaleOfSize(bits: u32) -> f32 {
  return bitcast<f32>(bits);
}

@if(!GEOMETRY_F32)
fn sizeBits(splat: u32) -> u32 {
  let first = geometry[splat][5];
  return max(max(first & 0xffffu, first >> 16u), geometry[splat][6] & 0xffffu);
}

@if(!GEOMETRY_F32)
fn scaleOfSize(steps: u32) -> f32 {
  return exactExp(parameters.logScales.x + parameters.logScales.y * f32(steps));
}
