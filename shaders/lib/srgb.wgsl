// The sRGB transfer function (IEC 61966-2-1), continued above 1 and, as an odd function, below 0.
// Reference: reference/srgb.ts.

fn encodeSrgb(linear: vec3f) -> vec3f {
  let size = abs(linear);
  return sign(linear) * select(1.055 * pow(size, vec3f(1.0 / 2.4)) - 0.055, 12.92 * size, size <= vec3f(0.0031308));
}

fn decodeSrgb(encoded: vec3f) -> vec3f {
  let size = abs(encoded);
  return sign(encoded) * select(pow((size + 0.055) / 1.055, vec3f(2.4)), size / 12.92, size <= vec3f(0.04045));
}
