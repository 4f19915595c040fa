import type { InvalidArgumentError } from '@websplatter/core';

/** Makes the error that names what cannot be. */
export type Refuse = (why: string) => InvalidArgumentError;

/** The values of parts `name:value`, by name. @throws what `refused` makes, of other names. */
export function namedParts(
  parts: readonly string[],
  names: readonly string[],
  refused: Refuse,
): Readonly<Record<string, string | undefined>> {
  const pairs = parts.map((part): [string, string] => {
    const at = part.indexOf(':');
    const name = part.slice(0, Math.max(0, at));
    if (!names.includes(name)) throw refused(`“${part}” is none of its parts`);
    return [name, part.slice(at + 1)];
  });
  return Object.fromEntries(pairs);
}

/** The finite number that a part is. @throws what `refused` makes, of other texts. */
export function numberPart(text: string, refused: Refuse): number {
  const value = text === '' ? Number.NaN : Number(text);
  if (!Number.isFinite(value)) throw refused(text === '' ? 'a number is missing' : `“${text}” is no number`);
  return value;
}
