/** How centres, rotations, scales, base colours and opacities are stored: 64 or 32 bytes per splat. */
export type GeometryPrecision = 'f32' | 'packed';

/** How the coefficients above degree 0 are stored; `u8` is a signed byte times a scale of the splat's own. */
export type ShPrecision = 'f32' | 'f16' | 'u8';

/** How a cloud is packed, or should be. */
export interface CloudPrecision {
  readonly geometryPrecision: GeometryPrecision;
  readonly shPrecision: ShPrecision;
}
