// docs/faults.md says what follows from a fault, and which test shows it: those tests must exist.
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, test } from 'vitest';
import { repositoryRoot } from '../setup.mjs';
import { testNames } from './test-names.mjs';

/** Rows of all tables that name a test. */
function rowsOf(text) {
  const lines = text.split('\n').filter((line) => /^\|(?! Fault |-)/.test(line));
  return lines.map((line) => {
    const [, fault, outcome, file, name] = /^\| (.+?) \| (.+?) \| `([^`]+)`: (.+) \|$/.exec(line) ?? [];
    return { line, fault, outcome, file, name };
  });
}

const known = new Map();
/** Names of the tests in a file. */
function namesIn(path) {
  const names = known.get(path) ?? testNames(path, readFileSync(path, 'utf8'));
  known.set(path, names);
  return names;
}

/** What is wrong with a row; null if nothing is. */
function flawOf({ line, file, name }) {
  if (!file) return `no fault, outcome and test: ${line}`;
  const path = join(repositoryRoot, file);
  if (!existsSync(path)) return `${file} does not exist`;
  return namesIn(path).includes(name) ? null : `${file} has no test "${name}"`;
}

test('docs/faults.md names a test that exists for each fault', () => {
  const [faults, figures] = readFileSync(join(repositoryRoot, 'docs/faults.md'), 'utf8').split('## Soaks');
  expect(figures).toBeDefined();
  const rows = rowsOf(faults);
  expect(rows.length).toBeGreaterThan(50);
  expect(rows.map(flawOf).filter((flaw) => flaw !== null)).toEqual([]);
});

test('a row without a test, or with one that is gone, is found', () => {
  const name = 'no such test';
  const own = 'packages/tools/package-checks/faults.test.mjs';
  const [bare, gone, moved] = rowsOf(
    `| a | b | |\n| a | b | \`packages/no.test.ts\`: c |\n| a | b | \`${own}\`: ${name} |\n`,
  );
  expect(flawOf(bare)).toBe('no fault, outcome and test: | a | b | |');
  expect(flawOf(gone)).toBe('packages/no.test.ts does not exist');
  expect(flawOf(moved)).toBe(`${own} has no test "${name}"`);
});
