import { wrongArgument } from '../given.ts';

/** @throws InvalidArgumentError unless `values` are `length` finite numbers. */
export function checkNumbers(argument: string, values: readonly number[], length: number): void {
  if (values?.length === length && Array.prototype.every.call(values, Number.isFinite)) return;
  throw wrongArgument(argument, values, `${length} finite numbers`);
}
