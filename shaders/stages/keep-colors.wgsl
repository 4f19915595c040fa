// Keeps the colours of the splats that the last frame drew, before the next frame overwrites their records.
// Reads the last frame's visible splats and records; writes keptColors. One thread per visible splat of that frame,
// dispatched per page.
// A splat that is seen from the same viewpoint again then needs no evaluation of its spherical harmonics.
import constants::CHUNK_SPLATS;
import constants::PROJECT_WORKGROUP;
import layout::Page;
import layout::PagePlan;
import layout::SplatRecord;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
import package::lib::kept_color::keptColor;
import package::lib::splat_record::colorOf;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> page: Page;
@group(0) @binding(2) var<storage, read> pagePlans: array<PagePlan>;
@group(0) @binding(3) var<storage, read> visibleSplats: array<u32>;
@group(0) @binding(4) var<storage, read> records: array<SplatRecord>;
/// The number of the viewpoint, then an entry per splat of the page.
@if(RECORD_F32) @group(0) @binding(5) var<storage, read_write> keptColors: array<vec4u>;
@if(!RECORD_F32) @group(0) @binding(5) var<storage, read_write> keptColors: array<vec2u>;

@compute @workgroup_size(PROJECT_WORKGROUP)
fn keepColors(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let plan = pagePlans[page.index];
  let indexInPage = linearWorkgroup(workgroup, view.dispatchRow) * PROJECT_WORKGROUP + lane;
  if (indexInPage >= plan.visibleCount) { return; }
  let index = plan.visibleStart + indexInPage;
  let splatIndex = visibleSplats[index] - page.chunkStart * CHUNK_SPLATS;
  keptColors[splatIndex + 1u] = keptColor(colorOf(records[index]), keptColors[0].x);
}
