// Composites the blended splats over the background.
// Reads the splats' layer and the background; writes an opaque colour. One fragment per pixel of the image.
// Works in the space that the splats were blended in, which is the display's.
import layout::CompositeParameters;
import package::lib::covering_triangle::coveringTriangle;

@group(0) @binding(0) var<uniform> parameters: CompositeParameters;
@group(0) @binding(1) var layer: texture_2d<f32>;

@vertex
fn vertexMain(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
  return coveringTriangle(vertex);
}

@fragment
fn fragmentMain(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let splats = textureLoad(layer, vec2u(position.xy), 0);
  return vec4f(splats.rgb + (1.0 - splats.a) * parameters.background, 1.0);
}
