// Finds how much of the splats lies in front of each of some points, and whether the host's depth
// does. Reads the records, in any order, and the depth that they are tested against; adds to two
// words per point: the absorption of splats in front, −ln(1 − opacity) in steps of 1/COVER_UNITS,
// and 1 where the host's depth is in front. One thread per visible splat and per point. Integers
// are added, so the order of the threads makes no difference.
import constants::COVER_UNITS;
import layout::CoverParameters;
import layout::CoverPoint;
import layout::SplatRecord;
import layout::View;
import package::lib::dispatch::linearWorkgroup;
import package::lib::splat_record::{fragmentAlpha, localCoordinate, localGradients, opacityOf};

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> parameters: CoverParameters;
@group(0) @binding(2) var<storage, read> visibleCount: u32;
@group(0) @binding(3) var<storage, read> records: array<SplatRecord>;
@group(0) @binding(4) var<storage, read> points: array<CoverPoint>;
@group(0) @binding(5) var<storage, read_write> covers: array<atomic<u32>>;
@if(DEPTH_TEST) @group(0) @binding(6) var testedDepth: texture_depth_2d;

@compute @workgroup_size(256)
fn coverPoints(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  let thread = linearWorkgroup(workgroup, view.dispatchRow) * 256u + lane;
  @if(DEPTH_TEST) if (thread < parameters.pointCount) { testHost(thread); }
  if (thread >= visibleCount) { return; }
  let splat = records[thread];
  let gradients = localGradients(splat);
  let opacity = opacityOf(splat);
  for (var i = 0u; i < parameters.pointCount; i++) {
    let point = points[i];
    if (splat.depthView >= point.depthView) { continue; }
    let local = localCoordinate(gradients, point.pixelPx - splat.centerPx);
    let alpha = fragmentAlpha(opacity, local, view.alphaCutoff);
    if (alpha > 0.0) { atomicAdd(&covers[2u * i], u32(round(-log(1.0 - alpha) * COVER_UNITS))); }
  }
}

@if(DEPTH_TEST)
fn testHost(i: u32) {
  let stored = textureLoad(testedDepth, vec2u(points[i].pixelPx), 0);
  @if(REVERSED_DEPTH) let isInFront = stored > points[i].storedDepth;
  @if(!REVERSED_DEPTH) let isInFront = stored < points[i].storedDepth;
  if (isInFront) { atomicAdd(&covers[2u * i + 1u], 1u); }
}
