// Packs spherical harmonics above degree 0, as data/packing/harmonics.ts does.
import package::lib::pack_splat::halfBits;

/// Bits of a splat's scale as binary16: `largest` is the largest magnitude of its coefficients.
/// Rounded up, so that the largest still fits in ±127.
fn scaleBitsOf(largest: f32) -> u32 {
  let bits = halfBits(largest);
  return select(bits, bits + 1u, unpack2x16float(bits).x < min(largest, 65504.0));
}

/// The scale of these bits. At least the smallest binary16 above 0, in case a device flushes
/// subnormal halves to 0: if the scale is 0, so are all values.
fn scaleOf(bits: u32) -> f32 {
  return max(unpack2x16float(bits).x, 5.960464477539063e-8);
}

/// The signed byte that stands for `value`.
fn byteOf(value: f32, scale: f32) -> u32 {
  return bitcast<u32>(i32(clamp(floor(value / scale * 127.0 + 0.5), -127.0, 127.0)));
}
