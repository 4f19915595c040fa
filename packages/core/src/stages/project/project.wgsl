// Projects every visible splat: computes its record (centre, axes, depth, colour) and its sort key.
// Reads the page's plan, the visible splats, the range of depths, the geometry with the ranges of
// packed log scales, and the spherical harmonics; writes records and keys in the order of
// visibleSplats. One thread per visible splat, dispatched per page; with
// INSTANCES, per batch of instances of one page. All splats of a page have the
// same degree of spherical harmonics, so it is a condition of linking instead of a branch.
import constants::CHUNK_SPLATS;
import constants::MAX_COLOR;
import constants::PROJECT_WORKGROUP;
import constants::SH_WORDS;
@if(COLOR_EFFECTS) import effects::changeColor;
@if(OPACITY_EFFECTS) import effects::changeOpacity;
@if(SCREEN_EFFECTS) import effects::changeScreen;
@if(SPLAT_EFFECTS) import effects::changeSplat;
@if(!GEOMETRY_F32) import layout::Chunk;
@if(!INSTANCES) import layout::Page;
import layout::PagePlan;
import layout::SplatRecord;
import layout::View;
import package::lib::covariance::screenAxes;
@if(!SHORT_KEYS) import package::lib::depth_key::depthKey;
@if(SHORT_KEYS) import package::lib::depth_key::shortDepthKey;
import package::lib::depth_key::sortDepth;
@if(DILATED) import package::lib::dilated_blob::{BlobPlace, dilatedBlob};
import package::lib::dispatch::linearWorkgroup;
@if(INSTANCES) import package::lib::instances::{enterInstance, page, pages};
import package::lib::packing::GEOMETRY_VECTORS;
import package::lib::packing::Splat;
import package::lib::packing::unpackSplat;
import package::lib::spherical_harmonics::shBase;
import package::lib::spherical_harmonics::shBasis1;
import package::lib::spherical_harmonics::shBasis2;
import package::lib::spherical_harmonics::shBasis3;
import package::lib::visible_ellipse::screenSplat;

@group(0) @binding(0) var<uniform> view: View;
@if(!INSTANCES) @group(0) @binding(1) var<uniform> page: Page;
@group(0) @binding(2) var<storage, read> pagePlans: array<PagePlan>;
@group(0) @binding(3) var<storage, read> visibleSplats: array<u32>;
/// Ordered bits of the farthest and, inverted, of the nearest depth (`sortDepth`). A uniform
/// because a stage may have no more than eight storage buffers.
@group(0) @binding(4) var<uniform> depthRange: vec2u;
@group(0) @binding(5) var<storage, read> geometry: array<array<vec4u, GEOMETRY_VECTORS>>;
@group(0) @binding(6) var<storage, read_write> records: array<SplatRecord>;
@group(0) @binding(7) var<storage, read_write> keys: array<u32>;
@if(SH_1) @group(0) @binding(8) var<storage, read> shRest: array<u32>;
@if(!GEOMETRY_F32) @group(0) @binding(9) var<storage, read> chunks: array<Chunk>;

@compute @workgroup_size(PROJECT_WORKGROUP)
fn project(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) lane: u32) {
  @if(INSTANCES) page.index = pages[0].index;
  let plan = pagePlans[page.index];
  let indexInPage = linearWorkgroup(workgroup, view.dispatchRow) * PROJECT_WORKGROUP + lane;
  if (indexInPage >= plan.visibleCount) { return; }
  let index = plan.visibleStart + indexInPage;
  @if(INSTANCES) enterInstance(visibleSplats[index] / CHUNK_SPLATS);
  let splatIndex = visibleSplats[index] - page.chunkStart * CHUNK_SPLATS;

  @if(!GEOMETRY_F32) let chunk = &chunks[splatIndex / CHUNK_SPLATS];
  @if(!GEOMETRY_F32) let logScales = vec2f((*chunk).minLogScale, (*chunk).logScaleStep);
  @if(!GEOMETRY_F32) let stored = unpackSplat(geometry[splatIndex], logScales);
  @if(GEOMETRY_F32 && !DILATED) let stored = unpackSplat(geometry[splatIndex]);
  @if(DILATED) let words = geometry[splatIndex];
  @if(DILATED) let place = BlobPlace(page.linear, page.translation, page.dilationPx2);
  @if(DILATED) let stored = dilatedBlob(view, place, words, unpackSplat(words));
  @if(!SPLAT_EFFECTS) let splat = stored;
  @if(SPLAT_EFFECTS) let splat = changeSplat(stored, splatIndex);
  let centerView = page.linear * splat.position + page.translation;
  let onScreen = screenSplat(view, page.linear, page.dilationPx2, splat, centerView);
  @if(!SCREEN_EFFECTS) let axes = screenAxes(onScreen.covariance, page.dilationPx2);
  @if(SCREEN_EFFECTS) let axes = screenAxes(changeScreen(onScreen).covariance, page.dilationPx2);

  var color = evaluatedColor(splat, splatIndex);
  @if(COLOR_EFFECTS) color = changeColor(color, splat, splatIndex, centerView);
  @if(!OPACITY_EFFECTS) let opacity = splat.opacity;
  @if(OPACITY_EFFECTS) let opacity = changeOpacity(splat.opacity, onScreen, page.dilationPx2);
  // A negative radiance has no meaning, and would darken the splats behind it; one beyond the
  // target's range would become infinite there, and NaN under the next splat.
  let rgba = vec4f(clamp(color, vec3f(0.0), vec3f(MAX_COLOR)), opacity);

  var record: SplatRecord;
  record.centerPx = onScreen.centerPx;
  @if(!RECORD_PAPER) record.majorPx = axes.majorPx;
  @if(!RECORD_PAPER) record.minorLengthPx = axes.minorLengthPx;
  @if(RECORD_PAPER) let majorUnit = axes.majorPx / length(axes.majorPx);
  @if(RECORD_PAPER) record.majorPx = packAxis(majorUnit, length(axes.majorPx));
  @if(RECORD_PAPER) record.minorPx = packAxis(vec2f(-majorUnit.y, majorUnit.x), axes.minorLengthPx);
  record.depthView = onScreen.depthView;
  @if(RECORD_F32) record.color = rgba;
  @if(RECORD_PAPER) record.color = pack4x8unorm(rgba);
  @if(!RECORD_F32 && !RECORD_PAPER) record.color = vec2u(pack2x16float(rgba.xy), pack2x16float(rgba.zw));
  records[index] = record;
  @if(!SHORT_KEYS) let key = depthKey(sortDepth(centerView, view.near), depthRange[0]);
  @if(SHORT_KEYS) let key = shortDepthKey(sortDepth(centerView, view.near), depthRange[0], ~depthRange[1]);
  keys[index] = key;
}

fn evaluatedColor(splat: Splat, splatIndex: u32) -> vec3f {
  var color = shBase(splat.colorDc);
  @if(SH_1) { color += shAboveBase(splatIndex, viewDirection(splat.position)); }
  return color;
}

/// Largest float16: longer axes would become infinite, and are shortened in their direction.
@if(RECORD_PAPER) const LONGEST_HALF_PX = 65504.0;

@if(RECORD_PAPER)
fn packAxis(unit: vec2f, lengthPx: f32) -> u32 {
  // A unit vector may be an ulp too long.
  let axisPx = clamp(unit * min(lengthPx, LONGEST_HALF_PX), vec2f(-LONGEST_HALF_PX), vec2f(LONGEST_HALF_PX));
  return pack2x16float(axisPx);
}

/// Unit vector along which harmonics are evaluated, from the camera to the splat: that in the world,
/// turned back by the rotation of the cloud; +z for singular model matrices.
@if(SH_1)
fn viewDirection(position: vec3f) -> vec3f {
  // A camera infinitely far away has weight 0: all directions are page.direction.
  let fromCamera = page.sight * (position - page.camera);
  let toward = fromCamera * page.cameraWeight + page.direction * (1.0 - page.cameraWeight);
  // Scale first: the square of a length in a very large or very small scene leaves float32's range.
  let largest = max(abs(toward.x), max(abs(toward.y), abs(toward.z)));
  if (!(largest > 1e-37)) { return vec3f(0.0, 0.0, 1.0); }
  return normalize(toward / largest);
}

@if(SH_1)
fn shAboveBase(splatIndex: u32, direction: vec3f) -> vec3f {
  // All entries of a palette come first, then the entry of each splat of the page, two to a word.
  var entry = splatIndex;
  @if(SH_PALETTE) entry = shRest[arrayLength(&shRest) - (page.splatCount + 1u) / 2u + splatIndex / 2u];
  @if(SH_PALETTE) entry = (entry >> (16u * (splatIndex % 2u))) & 0xffffu;
  let first = entry * SH_WORDS;
  var color = vec3f(0.0);
  let basis1 = shBasis1(direction);
  for (var k = 0u; k < 3u; k++) { color += basis1[k] * shCoefficient(first, k); }
  @if(SH_2) let basis2 = shBasis2(direction);
  @if(SH_2) for (var k = 0u; k < 5u; k++) { color += basis2[k] * shCoefficient(first, k + 3u); }
  @if(SH_3) let basis3 = shBasis3(direction);
  @if(SH_3) for (var k = 0u; k < 7u; k++) { color += basis3[k] * shCoefficient(first, k + 8u); }
  @if(SH_U8) color *= unpack2x16float(shRest[first]).x / 127.0;
  return color;
}

/// Coefficient `k` above degree 0, r, g, b, of the splat or entry whose words start at `first`; u8
/// coefficients are not scaled yet.
@if(SH_1)
fn shCoefficient(first: u32, k: u32) -> vec3f {
  return vec3f(shValue(first, 3u * k), shValue(first, 3u * k + 1u), shValue(first, 3u * k + 2u));
}

@if(SH_1 && SH_F32)
fn shValue(first: u32, i: u32) -> f32 {
  return bitcast<f32>(shRest[first + i]);
}

@if(SH_1 && SH_F16)
fn shValue(first: u32, i: u32) -> f32 {
  return unpack2x16float(shRest[first + i / 2u] >> (16u * (i % 2u))).x;
}

@if(SH_1 && SH_U8)
fn shValue(first: u32, i: u32) -> f32 {
  // The splat's scale takes the first two bytes.
  return f32(extractBits(bitcast<i32>(shRest[first + (i + 2u) / 4u]), 8u * ((i + 2u) % 4u), 8u));
}
