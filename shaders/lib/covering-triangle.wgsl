// Vertices for passes that draw every pixel of their target once: compose, composite and
// resolve-depth.

/// Returns corner `vertex`, 0 to 2, of one triangle that covers the target.
fn coveringTriangle(vertex: u32) -> vec4f {
  return vec4f(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
