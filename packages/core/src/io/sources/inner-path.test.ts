import { expect, test } from 'vitest';
import { folderOf, isInnerPath } from './inner-path.ts';

test.each(['a.webp', 'images/a.webp', '.a', 'a..b/...', 'a b/größe.webp', '%2e%2e%2fa', 'ab:c'])(
  '%s stays in its folder',
  (path) => expect(isInnerPath(path)).toBe(true),
);

/**
 * @fault Saved files: a scene names a file by reversed slashes, encoded dots or line breaks that lead out
 *   of its folder
 * @consequence `SplatFileError`; it is not fetched
 */
test.each([
  ...['', '.', '..', '../a', 'a/../../b', '/a', 'a//b', 'a/', '\\a', '..\\a', 'a\\..\\..\\b', '\\\\host\\a'],
  ...['%2e%2e/a', '.%2E/a', '.\t./a', 'a\n', 'a\0', 'C:a', 'c:\\a', `${'a'.repeat(1025)}`],
])('%j may lead out of its folder', (path) => expect(isInnerPath(path)).toBe(false));

test.each([
  ['meta.json', ''],
  ['a/meta.json', 'a/'],
  ['/a/b/', '/a/b/'],
  ['', ''],
])('the folder of %j is %j', (path, folder) => expect(folderOf(path)).toBe(folder));

test('the folder of a path of any length is found at once', () => {
  const folder = `${'a'.repeat(1e7)}/`;
  expect(folderOf(`${folder}meta.json`)).toBe(folder);
});
