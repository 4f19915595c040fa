import { InvalidArgumentError } from '../errors.ts';
import { shown } from '../printable.ts';

/** @throws InvalidArgumentError unless `values` are `length` finite numbers. */
export function checkNumbers(argument: string, values: readonly number[], length: number): void {
  if (values?.length === length && Array.prototype.every.call(values, Number.isFinite)) return;
  const message = `${argument} is ${shown(values)}; it must be ${length} finite numbers.`;
  throw new InvalidArgumentError(argument, message);
}
