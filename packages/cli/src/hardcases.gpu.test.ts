// Proves: the command runs the cases asked for, and sums them up as text, JSON, Markdown.
import { gpuTest } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { runMain } from './testing/test-folder.ts';

gpuTest('hardcases runs the cases that are asked for and sums up', async () => {
  const table = await runMain('hardcases', '--filter', 'scale-unit', '--size', '32x32');
  expect(table.out).toMatch(/^scale-unit .* pass$/m);
  expect(table.out).toMatch(
    /^1 of 1 chosen hard cases \(\d+ in all\) pass in [\d.]+ s \(.+, 32×32, \d{4}-\d\d-\d\d/m,
  );
  expect(table.status).toBe(0);

  // One that draws nothing.
  const json = JSON.parse((await runMain('hardcases', '--filter', 'sort-0-keys', '--json')).out);
  expect(json.results).toMatchObject([{ name: 'sort-0-keys', verdict: 'pass', failures: [] }]);
  const { out } = await runMain('hardcases', '--filter', 'sort-0-keys', '--markdown');
  expect(out).toMatch(/^\| sort \| sort-0-keys \|/m);
});
