/**
 * The anchor of a heading, as GitHub makes it, so that a link in a README leads to the same place
 * there and here. `heading` is its text without markup.
 */
export function slug(heading: string): string {
  return heading
    .trim()
    .toLowerCase()
    .replace(/[^\p{L}\p{N}\p{M}_ -]/gu, '')
    .replaceAll(' ', '-');
}
