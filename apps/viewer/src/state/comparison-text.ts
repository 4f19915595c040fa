import { InvalidArgumentError, isAccuracyTarget } from '@websplatter/core';
import { decodeAccuracy, encodeAccuracy } from './accuracy-address.ts';
import type { Comparison, ComparisonSide } from './comparison.ts';

/** Two images at once, and where the line between them is, 0…1 of the width. */
export interface LinkedComparison {
  readonly comparison: Comparison;
  readonly splitPart: number;
}

const FORM = 'write compare=error, or compare=current/fast/0.5 for two accuracies and the line between them';

/**
 * For the address: `error`, or both sides of a split image and its line:
 * `current/fast,resolutionScale:0.5/0.5`.
 */
export function encodeComparison({ comparison, splitPart }: LinkedComparison): string {
  if (comparison.kind === 'error') return 'error';
  return [sideText(comparison.left), sideText(comparison.right), splitPart].join('/');
}

/**
 * Reads the text of `encodeComparison`.
 *
 * @throws InvalidArgumentError naming the part that cannot be, and how a comparison is written.
 */
export function decodeComparison(text: string): LinkedComparison {
  if (text === 'error') return { comparison: { kind: 'error' }, splitPart: 0.5 };
  const [left, right, line = '0.5', ...others] = text.split('/');
  const splitPart = Number(line);
  if (right === undefined || others.length > 0) throw refused(`“${text}” has not two sides`);
  if (line === '' || !(splitPart >= 0 && splitPart <= 1))
    throw refused(`its line, “${line}”, does not lie between 0 and 1`);
  return { comparison: { kind: 'split', left: sideIn(left), right: sideIn(right) }, splitPart };
}

function sideText(side: ComparisonSide): string {
  return side === 'current' ? side : (encodeAccuracy(side, null) ?? '');
}

function sideIn(text: string): ComparisonSide {
  if (text === 'current') return text;
  const accuracy = decodeAccuracy(text);
  if (isAccuracyTarget(accuracy))
    throw refused(`“${text}” is a target, which only the chosen accuracy can be`);
  return accuracy;
}

function refused(why: string): InvalidArgumentError {
  return new InvalidArgumentError('compare', `The comparison cannot be read: ${why}; ${FORM}.`);
}
