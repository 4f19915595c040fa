import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { repositoryFiles } from './repository-files.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));

/** These tests run in the full run alone, untagged. */
const FULL_ALONE = /\.long(?:\.gpu)?\.test\.ts$|^packages\/conformance\/.*\.gpu\.test\.ts$|^e2e\//;

test('a test that tries more in the full run has a tag, without which the full run leaves it out', () => {
  const own = 'packages/tools/src/deeper-rule.test.ts';
  const files = repositoryFiles(root).filter((path) => /\.test\.(?:tsx?|mjs)$/.test(path) && path !== own);
  const texts = files
    .filter((path) => !FULL_ALONE.test(path))
    .map((path) => [path, readFileSync(join(root, path), 'utf8')] as const);
  const more = texts.filter(([, text]) => /\bWEBSPLATTER_FULL\b|\bIS_FULL\b|\bfuzz\(/.test(text));
  expect(more.length).toBeGreaterThan(20);
  expect(more.filter(([, text]) => !text.includes("tags: 'deeper'")).map(([path]) => path)).toEqual([]);
});
