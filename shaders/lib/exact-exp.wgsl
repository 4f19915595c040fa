// The exponential function for stored values, compared with the host's.

/// e^x for |x| ≤ 87, within two units in the last place. The built-in one may err by 3 + 2·|x|.
fn exactExp(x: f32) -> f32 {
  // x = k·ln 2 + r with |r| ≤ ½·ln 2. The first part of ln 2 has ten bits, so that its product with
  // k is exact.
  let k = round(x * 1.4426950408889634);
  let r = (x - k * 0.693359375) + k * 2.1219444005469058e-4;
  // The series up to r⁷: the rest is below 6e-9.
  let tail = 1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0));
  let power = 1.0 + (r + r * r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * tail))));
  return bitcast<f32>(bitcast<u32>(power) + (bitcast<u32>(i32(k)) << 23u));
}
