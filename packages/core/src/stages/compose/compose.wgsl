// Composes the blended splats over the host's image. Reads the splats' layer, the host's colours
// and, if needed, the layer's and the host's depths; writes the composed colours and, if requested,
// the splats' depth as the host stores it. Compute, one thread per pixel of the image: GPUs with a
// small rasteriser take many times as long for a render pass over all of it. The host keeps
// linear light and splats blend in sRGB's encoding, so the host's colour is encoded, covered, and
// decoded again: blending the decoded splats in linear light instead would lighten every pixel that
// they cover in part (white at half opacity over black: 188 instead of 128).
import constants::IMAGE_TILE_PX;
import layout::HostViewport;
@if(DEPTH_LAYER || MULTISAMPLED) import layout::HostDepth;
import package::lib::layer_rounding::rounded;
@if(DEPTH_LAYER) import package::lib::host_depth::storedDepth;
@if(MULTISAMPLED) import package::lib::host_depth::depthViewOf;
import package::lib::srgb::{decodeSrgb, encodeSrgb};

@group(0) @binding(0) var<uniform> viewport: HostViewport;
@group(0) @binding(1) var layer: texture_2d<f32>;
@group(0) @binding(2) var behind: texture_2d<f32>;
@if(DEPTH_LAYER) @group(0) @binding(3) var depthLayer: texture_2d<f32>;
@if(DEPTH_LAYER || MULTISAMPLED) @group(0) @binding(4) var<uniform> hostDepth: HostDepth;
@if(MULTISAMPLED) @group(0) @binding(5) var hostDepths: texture_depth_multisampled_2d;
/// Linear light, premultiplied, including the host's colour. Without a splat: the host's colour if
/// the image replaces it, or else opacity 0, which nothing else has.
@if(LAYER_F32) @group(0) @binding(6) var image: texture_storage_2d<rgba32float, write>;
@if(LAYER_F16) @group(0) @binding(6) var image: texture_storage_2d<rgba16float, write>;
/// Depth of the splats as the host stores it: median or mean, −1 where they cover less than half.
@if(DEPTH_LAYER) @group(0) @binding(7) var depthImage: texture_storage_2d<r32float, write>;
/// Share of the splats' picture, 0…1.
@if(FADED) @group(0) @binding(8) var<uniform> fade: f32;

const SIDE_PX = IMAGE_TILE_PX;

/// Largest float16: later passes of the host could not use an infinite colour.
const MAX_COLOR = 65504.0;

/// The splats at a pixel, premultiplied. They are faded after they are blended, in the space of the
/// display: the image is the mean of the pictures with and without them.
fn splatsAt(pixel: vec2u) -> vec4f {
  @if(!FADED) return textureLoad(layer, pixel, 0);
  @if(FADED) return fade * textureLoad(layer, pixel, 0);
}

/// Composes `splats`, encoded, over `host`, linear. Both, and the linear result, are premultiplied.
fn over(splats: vec4f, host: vec4f) -> vec4f {
  // Only straight colours can be encoded: a premultiplied one is divided by its opacity first.
  let hostEncoded = encodeSrgb(host.rgb / max(host.a, 1e-6)) * host.a;
  let through = 1.0 - splats.a;
  let opacity = splats.a + through * host.a;
  let covered = splats.rgb + through * hostEncoded;
  let color = decodeSrgb(covered / max(opacity, 1e-6)) * opacity;
  return vec4f(clamp(color, vec3f(-MAX_COLOR), vec3f(MAX_COLOR)), opacity);
}

/// Ratio of view depths from which a pixel's samples count as two surfaces, not one steep one.
@if(MULTISAMPLED) const EDGE_RATIO = 1.05;

/// Share of the pixel's samples that lie between two view depths.
@if(MULTISAMPLED) fn shareBetween(pixel: vec2u, nearest: f32, farthest: f32) -> f32 {
  let samples = textureNumSamples(hostDepths);
  var inside = 0u;
  for (var i = 0u; i < samples; i++) {
    let depth = depthViewOf(textureLoad(hostDepths, pixel + viewport.depthOriginPx, i), hostDepth);
    inside += u32(depth >= nearest && depth <= farthest);
  }
  return f32(inside) / f32(samples);
}

/// Composes a pixel that the edge of a mesh may cross. At an edge the pixel's layer shows the
/// splats behind the mesh, and its host colour is a mixture. The near surface's part is taken from
/// the neighbour that shows most of it, including the splats in front of it; the rest of the host's
/// colour is the far surface, which the pixel's own splats cover.
@if(MULTISAMPLED) fn overWithEdge(pixel: vec2u, splats: vec4f, host: vec4f) -> vec4f {
  let samples = textureNumSamples(hostDepths);
  var nearest = 3e38;
  var farthest = 0.0;
  for (var i = 0u; i < samples; i++) {
    let depth = depthViewOf(textureLoad(hostDepths, pixel + viewport.depthOriginPx, i), hostDepth);
    nearest = min(nearest, depth);
    farthest = max(farthest, depth);
  }
  if (farthest <= EDGE_RATIO * nearest) {
    return over(splats, host);
  }
  let share = shareBetween(pixel, 0.0, EDGE_RATIO * nearest);
  let last = vec2i(textureDimensions(layer)) - 1;
  var neighbor = pixel;
  var neighborShare = share;
  for (var i = 0; i < 9; i++) {
    let candidate = vec2u(clamp(vec2i(pixel) + vec2i(i % 3 - 1, i / 3 - 1), vec2i(0), last));
    let candidateShare = shareBetween(candidate, nearest / EDGE_RATIO, EDGE_RATIO * nearest);
    if (candidateShare > neighborShare) {
      neighbor = candidate;
      neighborShare = candidateShare;
    }
  }
  let nearHost = textureLoad(behind, neighbor + viewport.colorOriginPx, 0);
  // If no neighbour shows more of the near surface, near and far are the pixel itself.
  let farHost = max(host - share * nearHost, vec4f(0.0)) / (1.0 - share);
  return mix(over(splats, farHost), over(splatsAt(neighbor), nearHost), share);
}

@compute @workgroup_size(SIDE_PX, SIDE_PX)
fn compose(@builtin(global_invocation_id) thread: vec3u) {
  let pixel = thread.xy;
  // Beyond the edge, reads give anything and writes do nothing.
  let splats = splatsAt(pixel);
  @if(DEPTH_LAYER && !FADED) let weighted = textureLoad(depthLayer, pixel, 0).r;
  @if(DEPTH_LAYER && FADED) let weighted = fade * textureLoad(depthLayer, pixel, 0).r;
  @if(DEPTH_LAYER) let depthView = weighted / max(splats.a, 0.5);
  @if(DEPTH_LAYER) let middle = (vec2f(pixel) + 0.5) / vec2f(textureDimensions(layer));
  @if(DEPTH_LAYER) let ndc = (middle * 2.0 - 1.0) * vec2f(1.0, -1.0);
  @if(DEPTH_LAYER) let depth = storedDepth(max(depthView, 1e-30), ndc, hostDepth);
  @if(DEPTH_LAYER) textureStore(depthImage, pixel, vec4f(select(-1.0, depth, splats.a >= 0.5), 0.0, 0.0, 0.0));
  let isEmpty = splats.a <= 0.0;
  if (isEmpty && viewport.hasHost == 0u) {
    textureStore(image, pixel, vec4f(0.0));
    return;
  }
  let host = textureLoad(behind, pixel + viewport.colorOriginPx, 0);
  if (isEmpty) {
    textureStore(image, pixel, host);
    return;
  }
  @if(!MULTISAMPLED) let color = over(splats, host);
  @if(MULTISAMPLED) let color = overWithEdge(pixel, splats, host);
  textureStore(image, pixel, rounded(color));
}
