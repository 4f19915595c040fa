import type { FitMode } from './clouds/fit-settings.ts';
import { given, wrongArgument } from './data/given.ts';
import { checkOneOf, checkPrecision } from './data/packing/check-precision.ts';
import type { CloudPrecision } from './data/packing/precision.ts';

/** Requirement of a number: in words for messages, and as a test. */
type Rule = readonly [expected: string, isValid: (value: number) => boolean];

const AMOUNT: Rule = ['a number, 0 or more', (value) => value >= 0];
/** Options of an engine that are numbers. */
const ENGINE_NUMBERS: Readonly<Record<string, Rule>> = {
  tileBudgetBytes: AMOUNT,
  submissionBudgetMs: ['a number above 0', (value) => value > 0],
  memoryBudgetBytes: AMOUNT,
  streamBudgetBytes: AMOUNT,
};

const FIT_MODES: readonly FitMode[] = ['exact', 'auto'];

/** @throws InvalidArgumentError for a limit or budget that is out of range. Infinity is allowed. */
export function checkEngineNumbers(options: object): void {
  for (const [name, [expected, isValid]] of Object.entries(ENGINE_NUMBERS)) {
    const value: unknown = options[name as keyof typeof options];
    if (value === undefined || (typeof value === 'number' && isValid(value))) continue;
    throw wrongArgument(name, value, expected);
  }
}

/** @throws InvalidArgumentError if options are missing, or for an unknown precision or mode. */
export function checkLoadOptions(options: {
  readonly precision?: CloudPrecision;
  readonly fit?: FitMode;
  readonly budgetBytes?: number;
}): void {
  const { precision, fit, budgetBytes } = given(options, {
    name: 'a string?',
    onPreview: 'a function?',
  });
  checkOneOf('fit', fit, FIT_MODES);
  if (budgetBytes !== undefined && !(budgetBytes > 0))
    throw wrongArgument('budgetBytes', budgetBytes, 'a number of bytes, above 0');
  if (precision === undefined) return;
  checkPrecision(given(precision, {}, 'precision'));
}
