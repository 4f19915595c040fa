import { InvalidArgumentError } from '../errors.ts';
import { shown } from '../printable.ts';

/** From the finest on. */
export const GEOMETRY_PRECISIONS = ['f32', 'packed'] as const;
/** From the finest on. */
export const SH_PRECISIONS = ['f32', 'f16', 'u8'] as const;

/** How centres, rotations, scales, base colours and opacities are stored: 64 or 32 bytes per splat. */
export type GeometryPrecision = (typeof GEOMETRY_PRECISIONS)[number];

/** How the coefficients above degree 0 are stored; `u8` is a signed byte times a scale of the splat's own. */
export type ShPrecision = (typeof SH_PRECISIONS)[number];

/** How a cloud is packed, or should be. */
export interface CloudPrecision {
  readonly geometryPrecision: GeometryPrecision;
  readonly shPrecision: ShPrecision;
}

/** @throws InvalidArgumentError for a precision that there is not. */
export function checkPrecision({ geometryPrecision, shPrecision }: Partial<CloudPrecision>): void {
  checkOneOf('geometryPrecision', geometryPrecision, GEOMETRY_PRECISIONS);
  checkOneOf('shPrecision', shPrecision, SH_PRECISIONS);
}

/** @throws InvalidArgumentError for a value that is none of `values`. */
export function checkOneOf(name: string, value: string | undefined, values: readonly string[]): void {
  if (value === undefined || values.includes(value)) return;
  throw new InvalidArgumentError(name, `${name} is ${shown(value)}; it must be one of ${values.join(', ')}.`);
}
