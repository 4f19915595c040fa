import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { repositoryFiles } from './repository-files.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));
/** A package name on npm that belongs to others: outside of a clone, npx would run their code. */
const FOREIGN =
  /(?:npx|npm (?:exec|i|install|add)|pnpm (?:dlx|add)|yarn (?:dlx|add)|bunx)(?:\s+-\S+)*\s+websplatter\b/;

/**
 * @fault Pages and packages: a document or message tells people to run `websplatter` by npx, a package
 *   that is not ours
 * @consequence the tests fail: the package is `@websplatter/cli`
 */
test('nothing tells people to run or install the package that is called as the command', () => {
  expect(FOREIGN.test(`${'npx'} websplatter info`)).toBe(true);
  expect(FOREIGN.test('npx @websplatter/cli info')).toBe(false);
  const found = repositoryFiles(root).filter((path) =>
    FOREIGN.test(readFileSync(join(root, path), 'latin1')),
  );
  expect(found).toEqual([]);
});
