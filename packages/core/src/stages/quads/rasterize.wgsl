// Draws every visible splat as one quad, back to front. Reads the sorted order and the records;
// writes premultiplied colours, blended "over" in the space that scenes are trained in, and, if
// requested, mean depths. One instance of four vertices per visible splat, one fragment per pixel
// of its quad. The quad reaches as far as the splat's opacity stays above the cutoff; the
// fragment's place in the Gaussian comes from the interpolators alone.
import layout::HostDepth;
import layout::SplatRecord;
import layout::View;
@if(DEPTH_TEST) import package::lib::host_depth::storedDepth;
import package::lib::splat_record::{axesOf, fragmentAlpha, localCoordinate, localGradients, opacityOf};
import package::lib::visible_ellipse::reachInAxes;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> records: array<SplatRecord>;
@if(DEPTH_TEST) @group(0) @binding(3) var<uniform> hostDepth: HostDepth;

struct Varyings {
  @builtin(position) position: vec4f,
  /// The Gaussian is 2^(−|local|²).
  @location(0) local: vec2f,
  @if(RECORD_F32) @location(1) @interpolate(flat, either) color: vec4f,
  @if(RECORD_PAPER) @location(1) @interpolate(flat, either) color: u32,
  @if(!RECORD_F32 && !RECORD_PAPER) @location(1) @interpolate(flat, either) color: vec2u,
  @if(DEPTH_LAYER) @location(2) @interpolate(flat, either) depthView: f32,
}

struct Fragment {
  @location(0) color: vec4f,
  @if(DEPTH_LAYER) @location(1) depth: vec4f,
}

/// Grid of the corners, the coarsest to which WebGPU's rasterisers are known to snap them (1/16
/// px): the local coordinate of a corner then belongs to the place where the corner really is.
const SNAP_PX = 0.0625;
/// Largest distance of a corner from the image: fixed-point rasterisers have a limited range.
const GUARD_BAND_PX = 4096.0;

@vertex
fn vertexMain(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Varyings {
  let splat = records[order[instance]];
  let reach = reachInAxes(opacityOf(splat), view.alphaCutoff);
  let side = vec2f(f32(vertex & 1u), f32(vertex >> 1u)) * 2.0 - 1.0;

  let axes = axesOf(splat);
  let majorUnit = axes.majorUnit;
  let minorUnit = axes.minorUnit;
  // One extra step of the grid, so that snapping never cuts off a covered pixel.
  let halfSizePx = reach * vec2f(axes.majorLengthPx, axes.minorLengthPx) + SNAP_PX;

  // The part of the ellipse's box in the image: replaces the oriented quad if it is smaller.
  let extent = sqrt(
    (majorUnit * halfSizePx.x) * (majorUnit * halfSizePx.x) + (minorUnit * halfSizePx.y) * (minorUnit * halfSizePx.y),
  );
  let boxLow = clamp(splat.centerPx - extent, vec2f(0.0), view.sizePx);
  let boxHigh = clamp(splat.centerPx + extent, vec2f(0.0), view.sizePx);
  let boxSize = boxHigh - boxLow;
  let isBox = boxSize.x * boxSize.y < 4.0 * halfSizePx.x * halfSizePx.y
    || any(splat.centerPx - extent < vec2f(-GUARD_BAND_PX))
    || any(splat.centerPx + extent > view.sizePx + GUARD_BAND_PX);

  let oriented = splat.centerPx + side.x * halfSizePx.x * majorUnit + side.y * halfSizePx.y * minorUnit;
  let box = select(floor(boxLow), ceil(boxHigh), side > vec2f(0.0));
  let cornerPx = select(round(oriented / SNAP_PX) * SNAP_PX, box, isBox);

  var varyings: Varyings;
  let ndc = (cornerPx / view.sizePx * 2.0 - 1.0) * vec2f(1.0, -1.0);
  @if(!DEPTH_TEST) let depth = 0.0;
  @if(DEPTH_TEST) let depth = storedDepth(splat.depthView, ndc, hostDepth);
  varyings.position = vec4f(ndc, depth, 1.0);
  varyings.local = localCoordinate(localGradients(splat), cornerPx - splat.centerPx);
  varyings.color = splat.color;
  @if(DEPTH_LAYER) varyings.depthView = splat.depthView;
  return varyings;
}

@fragment
fn fragmentMain(varyings: Varyings) -> Fragment {
  @if(RECORD_F32) let color = varyings.color;
  @if(RECORD_PAPER) let color = unpack4x8unorm(varyings.color);
  @if(!RECORD_F32 && !RECORD_PAPER) let color = vec4f(unpack2x16float(varyings.color.x), unpack2x16float(varyings.color.y));
  let alpha = fragmentAlpha(color.w, varyings.local, view.alphaCutoff);
  // Blending 0 leaves the target unchanged, bit for bit, and unlike `discard` keeps early tests.
  var fragment: Fragment;
  fragment.color = vec4f(color.rgb * alpha, alpha);
  // Blended like a colour: the mean depth, weighted by contributions. Float16 targets end at 65504.
  @if(DEPTH_LAYER) fragment.depth = vec4f(min(varyings.depthView, 65504.0) * alpha, 0.0, 0.0, alpha);
  return fragment;
}
