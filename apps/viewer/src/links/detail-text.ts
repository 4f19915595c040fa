import { type Detail, InvalidArgumentError } from '@websplatter/core';
import { namedParts, numberPart } from './address-parts.ts';

/** Names of limits that an address can have. */
const NAMES = ['maxErrorPx', 'maxSplats'];

/** For the address: `maxSplats:1200000`; null for full detail. */
export function encodeDetail(detail: Detail): string | null {
  return detail === 'full' ? null : String(Object.entries(detail).map((limit) => limit.join(':')));
}

/**
 * Reads the text of `encodeDetail`.
 *
 * @throws InvalidArgumentError naming the part that cannot be, and how a detail is written.
 */
export function decodeDetail(text: string): Detail {
  if (text === 'full') return text;
  const limits = Object.entries(namedParts(text.split(','), NAMES, refused)).map(([name, written = '']) => {
    const limit = numberPart(written, refused);
    if (limit > 0 && (name !== 'maxSplats' || Number.isSafeInteger(limit))) return [name, limit];
    throw refused(`${name} cannot be ${limit}`);
  });
  return Object.fromEntries(limits) as Detail;
}

function refused(why: string): InvalidArgumentError {
  const form = 'write detail=maxSplats:1000000, detail=maxErrorPx:0.5, or both with a comma';
  return new InvalidArgumentError('detail', `The detail cannot be read: ${why}; ${form}.`);
}
