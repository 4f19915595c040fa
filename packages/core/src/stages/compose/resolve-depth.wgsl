// Copies the part of the host's depth that the splats' image covers. Reads the host's depth
// texture; writes the depth buffer that rasterize tests against. One fragment per pixel of the
// layer. If a pixel has several samples, the farthest decides: splats behind the edge of a mesh are
// drawn up to its last sample, and compose puts the mesh's part of the pixel back.
import layout::HostViewport;
import package::lib::covering_triangle::coveringTriangle;

@group(0) @binding(0) var<uniform> viewport: HostViewport;
@if(MULTISAMPLED) @group(0) @binding(1) var hostDepths: texture_depth_multisampled_2d;
@if(!MULTISAMPLED) @group(0) @binding(1) var hostDepths: texture_depth_2d;

@vertex
fn vertexMain(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
  return coveringTriangle(vertex);
}

@fragment
fn fragmentMain(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
  @if(!SCALED) let pixel = vec2u(position.xy) + viewport.depthOriginPx;
  @if(SCALED) let pixel = vec2u(position.xy * viewport.pxPerLayerPx) + viewport.depthOriginPx;
  var farthest = textureLoad(hostDepths, pixel, 0);
  @if(MULTISAMPLED) let samples = textureNumSamples(hostDepths);
  @if(MULTISAMPLED) for (var i = 1u; i < samples; i++) {
    let depth = textureLoad(hostDepths, pixel, i);
    @if(REVERSED_DEPTH) farthest = min(farthest, depth);
    @if(!REVERSED_DEPTH) farthest = max(farthest, depth);
  }
  return farthest;
}
