import type { FitMode } from './clouds/fit-settings.ts';
import { InvalidArgumentError } from './errors.ts';
import { type CloudPrecision, checkOneOf, checkPrecision } from './packing/precision.ts';
import { shown } from './printable.ts';

/** Options of an engine that are numbers: what each must be. */
const ENGINE_NUMBERS = {
  maxWorkgroupsPerDimension: ['a whole number, 1 or more', (value: number) => value >= 1 && isWhole(value)],
  tileBudgetBytes: ['a number, 0 or more', (value: number) => value >= 0],
  submissionBudgetMs: ['a number, more than 0', (value: number) => value > 0],
  memoryBudgetBytes: ['a number, 0 or more', (value: number) => value >= 0],
} as const;

const FIT_MODES: readonly FitMode[] = ['exact', 'auto'];

/** @throws InvalidArgumentError for a limit or a budget that is none. Infinity is one. */
export function checkEngineNumbers(options: Partial<Record<keyof typeof ENGINE_NUMBERS, number>>): void {
  for (const [name, [expected, isValid]] of Object.entries(ENGINE_NUMBERS)) {
    const value = options[name as keyof typeof ENGINE_NUMBERS];
    if (value === undefined || (typeof value === 'number' && isValid(value))) continue;
    throw new InvalidArgumentError(name, `${name} is ${shown(value)}; it must be ${expected}.`);
  }
}

/** @throws InvalidArgumentError for a precision or a mode that there is not. */
export function checkLoadOptions(options: {
  readonly precision?: CloudPrecision;
  readonly fit?: FitMode;
}): void {
  const { precision, fit } = options;
  checkOneOf('fit', fit, FIT_MODES);
  if (precision === undefined) return;
  if (typeof precision !== 'object' || precision === null) {
    const message = `precision is ${shown(precision)}; it must be { geometryPrecision, shPrecision }.`;
    throw new InvalidArgumentError('precision', message);
  }
  checkPrecision(precision);
}

/** Infinity is whole, too. */
function isWhole(value: number): boolean {
  return Math.floor(value) === value;
}
