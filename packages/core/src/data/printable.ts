/**
 * The part of an address that may hold credentials, and its prefix. Browsers take reversed slashes
 * too, and after http any number of them; blanks may be part of a password. Never tried in two
 * ways: texts can be megabytes.
 */
const AUTHORITY = /(:\/\/|\bhttps?:[/\\]*|(?<![^\s"'(])[/\\]{2})([^/\\?#]*)/gi;

/**
 * Text from outside as messages show it: without the credentials of addresses, and without
 * characters that terminals obey or that turn the direction of text.
 *
 * @hidden Shared with the packages beside this one.
 */
export function printable(text: string): string {
  return text
    .replace(AUTHORITY, (_, before, authority) => before + authority.slice(authority.lastIndexOf('@') + 1))
    .replace(/[\p{Cc}\p{Bidi_C}\u2028\u2029]/gu, '·');
}

/** Longest value that is printed whole, in characters. */
const MAX_VALUE_LENGTH = 80;
/** Characters of a text that are read: enough that some remain once credentials in URLs are removed. */
const MAX_READ_LENGTH = 1000;

/**
 * Any value as text for messages, even if it cannot become a string. Deep, long, wide or circular
 * values are read only as far as they are printed.
 *
 * @hidden Shared with the packages beside this one.
 */
export function shown(value: unknown): string {
  const text = textOf(value, MAX_READ_LENGTH);
  // The end of a text that is cut may be credentials of a URL.
  const whole = printable(text.length <= MAX_READ_LENGTH ? text : `${text.slice(0, MAX_READ_LENGTH)}@`);
  return whole.length <= MAX_VALUE_LENGTH ? whole : `${whole.slice(0, MAX_VALUE_LENGTH)}…`;
}

/** Whether a value is an array, or a typed one of numbers (not BigInts) whose memory is there. */
export function isArrayOrTyped(value: unknown): value is ArrayLike<unknown> {
  if (Array.isArray(value)) return true;
  if (!ArrayBuffer.isView(value) || value instanceof DataView || isDetached(value)) return false;
  return !(value instanceof BigInt64Array || value instanceof BigUint64Array);
}

/** Whether a value's memory is gone: transferred to another thread, or shrunk to less than it views. */
export function isDetached(value: unknown): boolean {
  const isView = ArrayBuffer.isView(value);
  if (!isView && !(value instanceof ArrayBuffer)) return false;
  try {
    if (value.byteLength > 0) return false;
    // Views and buffers of 0 bytes may be empty or detached; these calls throw only on detached ones.
    if (!isView) new Uint8Array(value);
    else if (!(value instanceof DataView)) (value as Uint8Array).values();
    return false;
  } catch {
    // A view or a buffer throws here only if it is detached.
    return true;
  }
}

/** Text of a value; characters after the first `length` may be missing. */
function textOf(value: unknown, length: number): string {
  // Each list or object around it has begun with a bracket, so that recursion ends before the stack does.
  if (length < 0) return '';
  try {
    if (isDetached(value)) return 'memory that was transferred or shrunk';
    const isList = isArrayOrTyped(value);
    if (!isList && !isPlain(value)) return String(value);
    const items = value as Readonly<Record<string | number, unknown>>;
    let text = '';
    for (const key of isList ? (value as unknown[]).keys() : Object.keys(items)) {
      if (text.length >= length) break;
      const item = items[key];
      const shownItem = textOf(typeof item === 'string' ? `"${item}"` : item, length - text.length - 1);
      text += `${text && ', '}${isList ? '' : `${key}: `}${shownItem}`;
    }
    return isList ? `[${text}]` : `{${text}}`;
  } catch {
    // A getter or a proxy of the caller throws; the message about the value must still be made.
    return `an unusual ${typeof value}`;
  }
}

function isPlain(value: unknown): boolean {
  if (typeof value !== 'object' || value === null) return false;
  const prototype = Object.getPrototypeOf(value);
  return prototype === null || prototype === Object.prototype;
}
