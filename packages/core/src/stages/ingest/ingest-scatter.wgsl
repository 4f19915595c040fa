// Writes successive words of all splats of a page. Reads these words for each splat of the cloud.
// One thread per splat of the page.
import constants::CHUNK_SPLATS;
import layout::PermuteParameters;
import package::lib::dispatch::linearWorkgroup;

@group(0) @binding(0) var<uniform> parameters: PermuteParameters;
@group(0) @binding(1) var<storage, read> words: array<u32>;
@group(0) @binding(2) var<storage, read_write> plane: array<u32>;

@compute @workgroup_size(CHUNK_SPLATS)
fn ingestScatter(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let splat = linearWorkgroup(workgroup, parameters.dispatchRow) * CHUNK_SPLATS + lane;
  if (splat >= parameters.pageEnd - parameters.pageStart) { return; }
  let at = splat * parameters.wordsPerSplat + parameters.word;
  let first = (parameters.pageStart + splat) * parameters.words;
  for (var i = 0u; i < parameters.words; i++) { plane[at + i] = words[first + i]; }
}
