// Real spherical harmonics with the signs that scenes are trained with. Reference:
// data/splats/spherical-harmonics.ts.

const SH_C0 = 0.28209479177387814; // √(1/4π)
const SH_C1 = 0.4886025119029199; // √(3/4π)
const SH_C2_XY = 1.0925484305920792; // √(15/4π)
const SH_C2_ZZ = 0.31539156525252005; // √(5/16π)
const SH_C3_XXX = 0.5900435899266435; // √(35/32π)
const SH_C3_XYZ = 2.890611442640554; // √(105/4π)
const SH_C3_XZZ = 0.4570457994644658; // √(21/32π)
const SH_C3_ZZZ = 0.3731763325901154; // √(7/16π)

fn shBase(dc: vec3f) -> vec3f {
  return 0.5 + SH_C0 * dc;
}

/// The three functions of degree 1 at the unit vector `d`, in ascending order.
fn shBasis1(d: vec3f) -> array<f32, 3> {
  return array<f32, 3>(-SH_C1 * d.y, SH_C1 * d.z, -SH_C1 * d.x);
}

/// The five functions of degree 2.
fn shBasis2(d: vec3f) -> array<f32, 5> {
  return array<f32, 5>(
    SH_C2_XY * d.x * d.y,
    -SH_C2_XY * d.y * d.z,
    SH_C2_ZZ * (2.0 * d.z * d.z - d.x * d.x - d.y * d.y),
    -SH_C2_XY * d.x * d.z,
    0.5 * SH_C2_XY * (d.x * d.x - d.y * d.y),
  );
}

/// The seven functions of degree 3.
fn shBasis3(d: vec3f) -> array<f32, 7> {
  let xx = d.x * d.x;
  let yy = d.y * d.y;
  let zz = d.z * d.z;
  return array<f32, 7>(
    -SH_C3_XXX * d.y * (3.0 * xx - yy),
    SH_C3_XYZ * d.x * d.y * d.z,
    -SH_C3_XZZ * d.y * (4.0 * zz - xx - yy),
    SH_C3_ZZZ * d.z * (2.0 * zz - 3.0 * xx - 3.0 * yy),
    -SH_C3_XZZ * d.x * (4.0 * zz - xx - yy),
    0.5 * SH_C3_XYZ * d.z * (xx - yy),
    -SH_C3_XXX * d.x * (xx - 3.0 * yy),
  );
}
