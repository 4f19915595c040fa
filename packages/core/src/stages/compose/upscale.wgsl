// Upscales a layer of splats that was drawn at a lower resolution, and its depths if it has some, to
// the image's size. Compute, one thread per pixel of the image: upscaling in a render pass took longer
// than drawing the splats (evidence/accuracy-settings.json). Bilinear between pixel centres, clamped
// at the edges. Colours are premultiplied, so they can be averaged directly. Reference:
// compose.reference.ts.
import constants::IMAGE_TILE_PX;
import layout::UpscaleParameters;
import package::lib::layer_rounding::rounded;

@group(0) @binding(0) var<uniform> parameters: UpscaleParameters;
@group(0) @binding(1) var layer: texture_2d<f32>;
@if(LAYER_F32) @group(0) @binding(2) var image: texture_storage_2d<rgba32float, write>;
@if(LAYER_F16) @group(0) @binding(2) var image: texture_storage_2d<rgba16float, write>;
@if(!LAYER_F32 && !LAYER_F16) @group(0) @binding(2) var image: texture_storage_2d<rgba8unorm, write>;
@if(DEPTH_LAYER) @group(0) @binding(3) var depthLayer: texture_2d<f32>;
@if(DEPTH_LAYER) @group(0) @binding(4) var depthImage: texture_storage_2d<r32float, write>;

const SIDE_PX = IMAGE_TILE_PX;

/// Interpolates `values` at `place`, which counts pixels from the middle of the first and lies
/// between the outermost middles.
fn bilinear(values: texture_2d<f32>, place: vec2f, last: vec2f) -> vec4f {
  let low = vec2u(place);
  let high = min(low + 1u, vec2u(last));
  let weight = place - vec2f(low);
  let top = mix(textureLoad(values, low, 0), textureLoad(values, vec2u(high.x, low.y), 0), weight.x);
  let bottom = mix(textureLoad(values, vec2u(low.x, high.y), 0), textureLoad(values, high, 0), weight.x);
  return mix(top, bottom, weight.y);
}

@compute @workgroup_size(SIDE_PX, SIDE_PX)
fn upscale(@builtin(global_invocation_id) pixel: vec3u) {
  let last = vec2f(textureDimensions(layer)) - 1.0;
  let middle = vec2f(pixel.xy) + 0.5;
  let place = clamp(middle * parameters.layerPerPx - 0.5, vec2f(0.0), last);
  // Beyond the edge, writes do nothing.
  textureStore(image, pixel.xy, rounded(bilinear(layer, place, last)));
  @if(DEPTH_LAYER) textureStore(depthImage, pixel.xy, bilinear(depthLayer, place, last));
}
