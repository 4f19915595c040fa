import { expect, test } from 'vitest';
import { isInnerPath } from './inner-path.ts';

test.each(['a.webp', 'images/a.webp', '.a', 'a..b/...', 'a b/größe.webp', '%2e%2e%2fa', 'ab:c'])(
  '%s stays in its folder',
  (path) => expect(isInnerPath(path)).toBe(true),
);

test.each([
  ...['', '.', '..', '../a', 'a/../../b', '/a', 'a//b', 'a/', '\\a', '..\\a', 'a\\..\\..\\b', '\\\\host\\a'],
  ...['%2e%2e/a', '.%2E/a', '.\t./a', 'a\n', 'a\0', 'C:a', 'c:\\a', `${'a'.repeat(1025)}`],
])('%j may lead out of its folder', (path) => expect(isInnerPath(path)).toBe(false));
