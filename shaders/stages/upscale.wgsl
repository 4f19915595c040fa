// Scales splats that were blended in a smaller layer to the image's size.
// Reads the smaller layer and, if there is one, its depths; writes both at the image's size. One fragment per pixel of the
// image. Bilinear between the middles of pixels, constant beyond the outermost. Values are premultiplied, so they can be
// averaged directly. Twin: reference/upscale.ts.
import layout::UpscaleParameters;
import package::lib::covering_triangle::coveringTriangle;

@group(0) @binding(0) var<uniform> parameters: UpscaleParameters;
@group(0) @binding(1) var layer: texture_2d<f32>;
@if(DEPTH_LAYER) @group(0) @binding(2) var depthLayer: texture_2d<f32>;

struct Upscaled {
  @location(0) color: vec4f,
  @if(DEPTH_LAYER) @location(1) depth: vec4f,
}

@vertex
fn vertexMain(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
  return coveringTriangle(vertex);
}

/// Interpolates `image` at `place`, which counts pixels from the middle of the first and lies between the outermost middles.
fn bilinear(image: texture_2d<f32>, place: vec2f, last: vec2f) -> vec4f {
  let low = vec2u(place);
  let high = min(low + 1u, vec2u(last));
  let weight = place - vec2f(low);
  let top = mix(textureLoad(image, low, 0), textureLoad(image, vec2u(high.x, low.y), 0), weight.x);
  let bottom = mix(textureLoad(image, vec2u(low.x, high.y), 0), textureLoad(image, high, 0), weight.x);
  return mix(top, bottom, weight.y);
}

@fragment
fn fragmentMain(@builtin(position) position: vec4f) -> Upscaled {
  let last = vec2f(textureDimensions(layer)) - 1.0;
  let place = clamp(position.xy * parameters.layerPerPx - 0.5, vec2f(0.0), last);
  var upscaled: Upscaled;
  upscaled.color = bilinear(layer, place, last);
  @if(DEPTH_LAYER) upscaled.depth = bilinear(depthLayer, place, last);
  return upscaled;
}
