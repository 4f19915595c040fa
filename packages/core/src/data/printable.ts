/**
 * The part of an address that may hold credentials, and its prefix. Browsers take reversed slashes
 * too, and after http any number of them; blanks may be part of a password. Never tried in two
 * ways: texts can be megabytes.
 */
const AUTHORITY = /(:\/\/|\bhttps?:[/\\]*|(?<![^\s"'(])[/\\]{2})([^/\\?#]*)/gi;

/**
 * Text from outside as messages show it: without the credentials of addresses, and without
 * characters that terminals obey or that turn the direction of text.
 */
export function printable(text: string): string {
  return text
    .replace(AUTHORITY, (_, before, authority) => before + authority.slice(authority.lastIndexOf('@') + 1))
    .replace(/[\p{Cc}\p{Bidi_C}\u2028\u2029]/gu, '·');
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
  const whole = printable(text);
  return whole.length <= MAX_VALUE_LENGTH ? whole : `${whole.slice(0, MAX_VALUE_LENGTH)}…`;
}
