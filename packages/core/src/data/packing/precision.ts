/** From the finest on. */
export const GEOMETRY_PRECISIONS = ['f32', 'packed'] as const;
/** From the finest on. */
export const SH_PRECISIONS = ['f32', 'f16', 'u8', 'palette'] as const;

/** Storage of centres, rotations, scales, base colours, opacities: 64 or 32 bytes per splat. */
export type GeometryPrecision = (typeof GEOMETRY_PRECISIONS)[number];

/**
 * How the coefficients above degree 0 are stored; `u8` is a signed byte times a scale of the
 * splat's own, and `palette` the number of an entry that splats share. Files without a palette have
 * `u8` then.
 */
export type ShPrecision = (typeof SH_PRECISIONS)[number];

/** Precisions in which each splat has coefficients of its own. */
export type OwnShPrecision = Exclude<ShPrecision, 'palette'>;

/** The precision of splats if a palette is wanted and the file has none: the next finer. */
export function ownShPrecision(wanted: ShPrecision): OwnShPrecision {
  return wanted === 'palette' ? 'u8' : wanted;
}

/** How a cloud is packed, or should be. */
export interface CloudPrecision {
  readonly geometryPrecision: GeometryPrecision;
  readonly shPrecision: ShPrecision;
}

/** How rows are packed one by one. */
export interface RowPrecision extends CloudPrecision {
  readonly shPrecision: OwnShPrecision;
}

/** How merged splats are stored: levels use the words that float32 geometry leaves empty. */
export const BLOB_PRECISION = { geometryPrecision: 'f32', shPrecision: 'u8' } as const;
