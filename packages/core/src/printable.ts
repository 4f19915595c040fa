/**
 * Text from outside as messages show it: without the credentials of addresses, and without characters that terminals obey or
 * that turn the direction of text.
 */
export function printable(text: string): string {
  return text.replace(/:\/\/[^\s/?#]*@/g, '://').replace(/[\p{Cc}\p{Bidi_C}\u2028\u2029]/gu, '·');
}
