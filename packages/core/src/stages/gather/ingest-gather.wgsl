// Takes successive words of the splats of a page that a list names, in the order of the list. Reads
// a plane and the list of splats; writes these words for each. One thread per entry of the list.
import constants::CHUNK_SPLATS;
import layout::PermuteParameters;
import package::lib::dispatch::linearWorkgroup;

@group(0) @binding(0) var<uniform> parameters: PermuteParameters;
@group(0) @binding(1) var<storage, read> plane: array<u32>;
@group(0) @binding(2) var<storage, read> list: array<u32>;
@group(0) @binding(3) var<storage, read_write> words: array<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn ingestGather(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let place = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_SPLATS + lane;
  if (place >= parameters.count) { return; }
  let splat = list[place];
  if (splat < parameters.pageStart || splat >= parameters.pageEnd) { return; }
  let at = (splat - parameters.pageStart) * parameters.wordsPerSplat + parameters.word;
  for (var i = 0u; i < parameters.words; i++) {
    let isLast = i + 1u == parameters.words;
    words[place * parameters.words + i] = plane[at + i] & select(0xffffffffu, parameters.mask, isLast);
  }
}
