// Float64 arithmetic in integers, exactly as in IEEE 754: rounded to nearest, ties to even. Pairs of
// float32 would need error-free sums, which compilers may reorder or fuse; integer operations they may
// not. A number is two words, low word first. Subnormal numbers count as 0; infinities and NaN do not
// occur.

const F64_SIGN = 0x80000000u;
/// The bit that is set above every mantissa, in the upper word.
const F64_IMPLICIT = 0x00100000u;
const F64_BIAS = 1023u;

/// The float64 that equals a float32, given by its bits.
fn float64Of(bits: u32) -> vec2u {
  let exponent = extractBits(bits, 23u, 8u);
  if (exponent == 0u) { return vec2u(0u); }
  let high = (bits & F64_SIGN) | ((exponent + F64_BIAS - 127u) << 20u) | extractBits(bits, 3u, 20u);
  return vec2u(bits << 29u, high);
}

fn negated64(a: vec2u) -> vec2u {
  return vec2u(a.x, a.y ^ F64_SIGN);
}

fn exponentOf64(a: vec2u) -> u32 {
  return extractBits(a.y, 20u, 11u);
}

/// The 53 bits of a mantissa with the implicit one, shifted left by `shift`, 1 to 11.
fn significandOf64(a: vec2u, shift: u32) -> vec2u {
  let high = (a.y & (F64_IMPLICIT - 1u)) | F64_IMPLICIT;
  return vec2u(a.x << shift, (high << shift) | (a.x >> (32u - shift)));
}

/// Shifts right; the lowest bit tells whether any bit that left was set.
fn shiftedRight64(a: vec2u, count: u32) -> vec2u {
  if (count == 0u) { return a; }
  if (count >= 64u) { return vec2u(u32((a.x | a.y) != 0u), 0u); }
  var words = a;
  var lost = 0u;
  if (count >= 32u) {
    lost = words.x;
    words = vec2u(words.y, 0u);
  }
  let bits = count & 31u;
  if (bits > 0u) {
    lost |= words.x << (32u - bits);
    words = vec2u((words.x >> bits) | (words.y << (32u - bits)), words.y >> bits);
  }
  return vec2u(words.x | u32(lost != 0u), words.y);
}

/// Rounds `significand`, whose highest set bit is bit 62, to 53 bits, and packs it with `exponent`, the
/// biased exponent of the result.
fn rounded64(sign: u32, exponent: i32, significand: vec2u) -> vec2u {
  if (exponent <= 0) { return vec2u(0u, sign); }
  let rest = significand.x & 0x3ffu;
  let low = significand.x + 0x200u;
  let high = significand.y + u32(low < 0x200u);
  var mantissa = vec2u((low >> 10u) | (high << 22u), high >> 10u);
  if (rest == 0x200u) { mantissa.x &= 0xfffffffeu; }
  // The implicit bit adds one to the exponent, and so does a carry out of the mantissa.
  return vec2u(mantissa.x, sign + (u32(exponent - 1) << 20u) + mantissa.y);
}

/// a + b.
fn sum64(a: vec2u, b: vec2u) -> vec2u {
  let magnitudes = vec2u(a.y, b.y) & vec2u(~F64_SIGN);
  let isSwapped = magnitudes.x < magnitudes.y || (magnitudes.x == magnitudes.y && a.x < b.x);
  let large = select(a, b, isSwapped);
  let small = select(b, a, isSwapped);
  let exponent = exponentOf64(large);
  let smallExponent = exponentOf64(small);
  if (smallExponent == 0u) { return select(large, vec2u(0u), exponent == 0u); }
  let sign = large.y & F64_SIGN;
  let one = significandOf64(large, 10u);
  let other = shiftedRight64(significandOf64(small, 10u), exponent - smallExponent);
  if (sign == (small.y & F64_SIGN)) {
    let low = one.x + other.x;
    let sum = vec2u(low, one.y + other.y + u32(low < one.x));
    if ((sum.y & F64_SIGN) != 0u) { return rounded64(sign, i32(exponent) + 1, shiftedRight64(sum, 1u)); }
    return rounded64(sign, i32(exponent), sum);
  }
  let difference = vec2u(one.x - other.x, one.y - other.y - u32(one.x < other.x));
  if ((difference.x | difference.y) == 0u) { return vec2u(0u); }
  // Up to bit 62.
  let zeros = select(countLeadingZeros(difference.y), 32u + countLeadingZeros(difference.x), difference.y == 0u) - 1u;
  var shifted = difference;
  if (zeros >= 32u) { shifted = vec2u(0u, difference.x); }
  let bits = zeros & 31u;
  if (bits > 0u) { shifted = vec2u(shifted.x << bits, (shifted.y << bits) | (shifted.x >> (32u - bits))); }
  return rounded64(sign, i32(exponent) - i32(zeros), shifted);
}

/// All 64 bits of a product.
fn multiplied32(a: u32, b: u32) -> vec2u {
  let low = vec2u(a, b) & vec2u(0xffffu);
  let high = vec2u(a, b) >> vec2u(16u);
  let bottom = low.x * low.y;
  let first = low.x * high.y + (bottom >> 16u);
  let second = high.x * low.y + (first & 0xffffu);
  return vec2u((bottom & 0xffffu) | (second << 16u), high.x * high.y + (first >> 16u) + (second >> 16u));
}

/// a · b.
fn product64(a: vec2u, b: vec2u) -> vec2u {
  let sign = (a.y ^ b.y) & F64_SIGN;
  let exponents = vec2u(exponentOf64(a), exponentOf64(b));
  if (exponents.x == 0u || exponents.y == 0u) { return vec2u(0u, sign); }
  let one = significandOf64(a, 10u);
  let other = significandOf64(b, 11u);
  let bottom = multiplied32(one.x, other.x);
  let first = multiplied32(one.x, other.y);
  let second = multiplied32(one.y, other.x);
  let top = multiplied32(one.y, other.y);
  // Of the product's four words: the carries into the upper two, and whether the lower are 0.
  let middleFirst = bottom.y + first.x;
  let middle = middleFirst + second.x;
  let carry = u32(middleFirst < first.x) + u32(middle < second.x);
  let lowFirst = top.x + first.y;
  let lowSecond = lowFirst + second.y;
  let low = lowSecond + carry;
  let high = top.y + u32(lowFirst < first.y) + u32(lowSecond < second.y) + u32(low < carry);
  let exponent = i32(exponents.x) + i32(exponents.y) - i32(F64_BIAS);
  let isLost = u32((bottom.x | middle) != 0u);
  // The highest bit is bit 62, or 61.
  if ((high & 0x40000000u) != 0u) { return rounded64(sign, exponent + 1, vec2u(low | isLost, high)); }
  return rounded64(sign, exponent, vec2u((low << 1u) | isLost, (high << 1u) | (low >> 31u)));
}

/// Maps a float64 to words in the order of the numbers, the upper one first; −0 and 0 to the same.
fn orderedWords64(a: vec2u) -> vec2u {
  if ((a.x | (a.y & ~F64_SIGN)) == 0u) { return vec2u(0u, F64_SIGN); }
  if ((a.y & F64_SIGN) != 0u) { return ~a; }
  return vec2u(a.x, a.y | F64_SIGN);
}
