// Values as the formats of layers keep them, for compute shaders that write layers.

/// Rounds to the nearest value of the layer's format: adapters may write the one below instead.
fn rounded(color: vec4f) -> vec4f {
  @if(LAYER_F32) return color;
  @if(LAYER_F16) let bits = bitcast<vec4u>(color);
  // Ties go to the even value. Halves keep 13 bits fewer than floats, except below 6·10⁻⁵ (subnormals).
  @if(LAYER_F16) return bitcast<vec4f>((bits + 0xfffu + ((bits >> vec4u(13u)) & vec4u(1u))) & vec4u(0xffffe000u));
  // A quarter of a step above the value, so that neither kind of rounding reaches another.
  @if(!LAYER_F32 && !LAYER_F16) return (floor(clamp(color, vec4f(0.0), vec4f(1.0)) * 255.0 + 0.5) + 0.25) / 255.0;
}
