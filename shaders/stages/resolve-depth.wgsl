// Copies the part of the host's depth that the splats' picture covers. Of several samples the first decides, so that what
// hides a splat is one of the host's own surfaces.
import layout::HostViewport;

@group(0) @binding(0) var<uniform> viewport: HostViewport;
@if(MULTISAMPLED) @group(0) @binding(1) var hostDepths: texture_depth_multisampled_2d;
@if(!MULTISAMPLED) @group(0) @binding(1) var hostDepths: texture_depth_2d;

@vertex
fn vertexMain(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4f {
  // One triangle that covers the target.
  return vec4f(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragmentMain(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
  return textureLoad(hostDepths, vec2u(position.xy) + viewport.originPx, 0);
}
