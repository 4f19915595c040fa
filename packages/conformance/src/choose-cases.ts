import { InvalidArgumentError } from '@websplatter/core';
import { HARD_CASES } from './catalogue.ts';
import type { HardCase } from './hard-case.ts';

/**
 * Returns the hard cases with these names, in the order of the catalogue.
 *
 * @throws InvalidArgumentError listing the unknown names.
 */
export function chooseCases(names: readonly string[]): readonly HardCase[] {
  const unknown = names.filter((name) => !HARD_CASES.some((hardCase) => hardCase.name === name));
  if (unknown.length > 0) {
    const list = unknown.map((name) => `“${name}”`).join(', ');
    throw new InvalidArgumentError('cases', `There is no hard case ${list}.`);
  }
  return HARD_CASES.filter(({ name }) => names.includes(name));
}
