import { wrongArgument } from '../given.ts';
import { type CloudPrecision, GEOMETRY_PRECISIONS, SH_PRECISIONS } from './precision.ts';

/** @throws InvalidArgumentError for a precision that there is not. */
export function checkPrecision({ geometryPrecision, shPrecision }: Partial<CloudPrecision>): void {
  checkOneOf('geometryPrecision', geometryPrecision, GEOMETRY_PRECISIONS);
  checkOneOf('shPrecision', shPrecision, SH_PRECISIONS);
}

/** @throws InvalidArgumentError for a value that is none of `values`. */
export function checkOneOf(name: string, value: string | undefined, values: readonly string[]): void {
  if (value === undefined || values.includes(value)) return;
  throw wrongArgument(name, value, `one of ${values.join(', ')}`);
}
