import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { repositoryFiles } from './repository-files.ts';
import { MOST_WORDS, wordsProblems } from './words-rule.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));
/** Changelogs and decisions tell history; texts of others are theirs. */
const EXEMPT = /(?:^|\/)CHANGELOG\.md$|^docs\/decisions\/|^CODE_OF_CONDUCT\.md$|^\.changeset\//;

const pages = repositoryFiles(root)
  .filter((path) => path.endsWith('.md') && !EXEMPT.test(path))
  .map((path) => ({ path, text: readFileSync(join(root, path), 'utf8') }));

test(`no sentence has more than ${MOST_WORDS} words, and no page names a commit`, () => {
  const found = pages.flatMap(({ path, text }) =>
    wordsProblems(text).map(({ line, problem }) => `${path}:${line}: ${problem}`),
  );
  expect(found).toEqual([]);
});

test('a long sentence and a commit are found, wherever they stand, and nothing else', () => {
  const long = `One${' more'.repeat(MOST_WORDS)}.`;
  const found = (markdown: string) => wordsProblems(markdown).map(({ line }) => line);
  expect(found(`# Title\n\nShort.\n${long}`)).toEqual([3]);
  expect(found(`- Short.\n- ${long}`)).toEqual([2]);
  expect(found(`---\ntitle: ${long}\n---\n\n${long}`)).toEqual([5]);
  expect(found('Measured at 26f22f6.\n\nSince commit one.')).toEqual([1, 3]);
  expect(found(`\`\`\`\n${long} 26f22f6\n\`\`\`\n\n| ${long} |\n\n## ${long}`)).toEqual([]);
  expect(found(`${'Short. '.repeat(40)}`)).toEqual([]);
  expect(found('In 1234567 of cases, and the deadbeef of words.')).toEqual([]);
});
