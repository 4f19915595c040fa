import type { FitMode } from './clouds/fit-settings.ts';
import { InvalidArgumentError } from './errors.ts';
import { type CloudPrecision, checkOneOf, checkPrecision } from './packing/precision.ts';
import { shown } from './printable.ts';

/** Options of an engine that are numbers, and whether each may be 0. */
const ENGINE_NUMBERS = {
  maxWorkgroupsPerDimension: false,
  tileBudgetBytes: true,
  submissionBudgetMs: false,
  memoryBudgetBytes: true,
};

const FIT_MODES: readonly FitMode[] = ['exact', 'auto'];

/** @throws InvalidArgumentError for a limit or a budget that is none. Infinity is one. */
export function checkEngineNumbers(options: Partial<Record<keyof typeof ENGINE_NUMBERS, number>>): void {
  for (const [name, mayBeZero] of Object.entries(ENGINE_NUMBERS)) {
    const value = options[name as keyof typeof ENGINE_NUMBERS];
    if (value === undefined) continue;
    if (typeof value === 'number' && (value > 0 || (mayBeZero && value === 0))) continue;
    const expected = mayBeZero ? '0 or more' : 'more than 0';
    throw new InvalidArgumentError(name, `${name} is ${shown(value)}; it must be a number, ${expected}.`);
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
