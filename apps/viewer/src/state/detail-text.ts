import { checkDetail, type Detail } from '@websplatter/core';

/** For the address: `auto`, `maxSplats:1200000`. */
export function encodeDetail(detail: Detail): string {
  if (typeof detail === 'string') return detail;
  return String(Object.entries(detail).map((part) => part.join(':')));
}

/**
 * Reads the text of `encodeDetail`.
 *
 * @throws InvalidArgumentError if there is no such detail, with those that there are.
 */
export function decodeDetail(text: string): Detail {
  const asked = text.includes(':') ? Object.fromEntries(text.split(',').map(numberIn)) : text;
  const detail = asked as Detail;
  checkDetail(detail);
  return detail;
}

function numberIn(part: string): [name: string, value: number] {
  const [name, value] = part.split(':');
  return [name, value ? Number(value) : Number.NaN];
}
