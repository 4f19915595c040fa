// Floats as bits. Devices may flush subnormal numbers to zero and may assume that there are no NaNs
// and infinities, so a file's values are tested and kept as bits.

const EXPONENT_BITS = 0x7f800000u;
const MAGNITUDE_BITS = 0x7fffffffu;
const NEGATIVE_INFINITY_BITS = 0xff800000u;
const TWO_TO_MINUS_60_BITS = 0x21800000u;
const TWO_TO_100_BITS = 0x71800000u;
const TWO_TO_100 = 1.2676506002282294e30;
const TWO_TO_MINUS_100 = 7.888609052210118e-31;

fn isFiniteBits(bits: u32) -> bool {
  return (bits & EXPONENT_BITS) != EXPONENT_BITS;
}

fn isNanBits(bits: u32) -> bool {
  return (bits & MAGNITUDE_BITS) > EXPONENT_BITS;
}

/// A number that grows with the float, infinities included, and is above 0. −0 comes before 0.
fn orderedBits(bits: u32) -> u32 {
  return select(bits | 0x80000000u, ~bits, (bits >> 31u) == 1u);
}

/// The bits of which `orderedBits` is this.
fn fromOrderedBits(ordered: u32) -> u32 {
  return select(~ordered, ordered & MAGNITUDE_BITS, (ordered >> 31u) == 1u);
}

/// The bits of a coordinate less its origin; its own, subnormal ones too, for an origin of 0.
fn aboutOrigin(bits: u32, origin: f32) -> u32 {
  if (origin == 0.0) { return bits; }
  return bitcast<u32>(bitcast<f32>(bits) - origin);
}

/// Whether both floats are equal: the same bits, or both of them 0.
fn isEqualBits(a: u32, b: u32) -> bool {
  return a == b || ((a | b) & MAGNITUDE_BITS) == 0u;
}
