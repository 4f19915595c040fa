// Packs and unpacks a kept colour: a splat's colour and the number of the viewpoint that it was evaluated for, kept from
// frame to frame. Written by keep-colors and project, read by project, per visible splat. The colour is as exact as the
// record that it goes into. Viewpoint 0 means that no colour is kept.
@if(RECORD_F32)
fn keptColor(color: vec3f, viewpoint: u32) -> vec4u {
  return vec4u(bitcast<vec3u>(color), viewpoint);
}

@if(RECORD_F32)
fn isKeptFor(kept: vec4u, viewpoint: u32) -> bool {
  return kept.w == viewpoint;
}

@if(RECORD_F32)
fn colorOfKept(kept: vec4u) -> vec3f {
  return bitcast<vec3f>(kept.xyz);
}

@if(!RECORD_F32)
fn keptColor(color: vec3f, viewpoint: u32) -> vec2u {
  return vec2u(pack2x16float(color.xy), (pack2x16float(vec2f(color.z, 0.0)) & 0xffffu) | (viewpoint << 16u));
}

@if(!RECORD_F32)
fn isKeptFor(kept: vec2u, viewpoint: u32) -> bool {
  return kept.y >> 16u == viewpoint;
}

@if(!RECORD_F32)
fn colorOfKept(kept: vec2u) -> vec3f {
  return vec3f(unpack2x16float(kept.x), unpack2x16float(kept.y).x);
}
