/**
 * A heading's anchor in GitHub's format, so that a README's links work on GitHub and on the site.
 * `heading` is its text without markup.
 */
export function slug(heading: string): string {
  return heading
    .trim()
    .toLowerCase()
    .replace(/[^\p{L}\p{N}\p{M}_ -]/gu, '')
    .replaceAll(' ', '-');
}
