/**
 * Text from outside as messages show it: without the credentials of addresses, and without characters that terminals obey or
 * that turn the direction of text.
 */
export function printable(text: string): string {
  return text.replace(/:\/\/[^\s/?#]*@/g, '://').replace(/[\p{Cc}\p{Bidi_C}\u2028\u2029]/gu, '·');
}

/** Longest value that is shown whole. */
const MAX_VALUE_LENGTH = 80;

/** Any value as messages show it, those included that cannot become text. */
export function shown(value: unknown): string {
  let text: string;
  try {
    text = Array.isArray(value)
      ? `[${value.slice(0, MAX_VALUE_LENGTH).map(shown).join(', ')}]`
      : String(value);
  } catch {
    text = `an unusual ${typeof value}`;
  }
  return printable(text.length <= MAX_VALUE_LENGTH ? text : `${text.slice(0, MAX_VALUE_LENGTH)}…`);
}
