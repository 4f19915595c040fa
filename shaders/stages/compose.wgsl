// Puts the blended splats over what the host has drawn so far. The host keeps linear light and splats blend in sRGB's
// encoding, so what is behind is encoded, covered, and decoded again: blending the decoded splats in linear light instead
// would lighten every pixel that they cover in part (white at half opacity over black: 188 instead of 128).
import layout::HostViewport;
@if(DEPTH_LAYER) import layout::HostDepth;
@if(DEPTH_LAYER) import package::lib::host_depth::storedDepth;
import package::lib::srgb::{decodeSrgb, encodeSrgb};

@group(0) @binding(0) var<uniform> viewport: HostViewport;
@group(0) @binding(1) var layer: texture_2d<f32>;
@group(0) @binding(2) var behind: texture_2d<f32>;
@if(DEPTH_LAYER) @group(0) @binding(3) var depthLayer: texture_2d<f32>;
@if(DEPTH_LAYER) @group(0) @binding(4) var<uniform> hostDepth: HostDepth;

struct Picture {
  /// Linear light, premultiplied, what is behind included; opacity 0 exactly where there is no splat.
  @location(0) color: vec4f,
  /// Mean depth of the splats as the host stores depth, −1 where they cover less than half.
  @if(DEPTH_LAYER) @location(1) depth: vec4f,
}

/// Largest float16: an infinity would be no colour for what comes after.
const MAX_COLOR = 65504.0;

@vertex
fn vertexMain(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
  // One triangle that covers the target.
  return vec4f(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragmentMain(@builtin(position) position: vec4f) -> Picture {
  let pixel = vec2u(position.xy);
  let splats = textureLoad(layer, pixel, 0);
  let host = textureLoad(behind, pixel + viewport.originPx, 0);
  // Encoding is for straight colours: a premultiplied one is divided by its opacity first.
  let hostEncoded = encodeSrgb(host.rgb / max(host.a, 1e-6)) * host.a;
  let through = 1.0 - splats.a;
  let opacity = splats.a + through * host.a;
  let covered = splats.rgb + through * hostEncoded;
  let color = clamp(decodeSrgb(covered / max(opacity, 1e-6)) * opacity, vec3f(-MAX_COLOR), vec3f(MAX_COLOR));
  var picture: Picture;
  picture.color = select(vec4f(0.0), vec4f(color, opacity), splats.a > 0.0);
  @if(DEPTH_LAYER) let depthView = textureLoad(depthLayer, pixel, 0).r / max(splats.a, 0.5);
  @if(DEPTH_LAYER) let ndc = (position.xy / vec2f(textureDimensions(layer)) * 2.0 - 1.0) * vec2f(1.0, -1.0);
  @if(DEPTH_LAYER) let depth = storedDepth(max(depthView, 1e-30), ndc, hostDepth);
  @if(DEPTH_LAYER) picture.depth = vec4f(select(-1.0, depth, splats.a >= 0.5), 0.0, 0.0, 0.0);
  return picture;
}
