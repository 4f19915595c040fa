import { readFileSync } from 'node:fs';
import { expect, test, vi } from 'vitest';
import { TESTED_RELEASES, warnOfUntestedThree } from './errors.ts';

const { oldest, newest } = TESTED_RELEASES;

test('an unknown release of three warns once, and a known one never', () => {
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
  for (const revision of [`${oldest}`, `${newest}`, `${newest}dev`]) warnOfUntestedThree(revision);
  expect(warn).not.toHaveBeenCalled();
  for (const revision of [`${newest + 1}`, `${newest + 1}dev`, `${oldest - 1}`])
    warnOfUntestedThree(revision);
  expect(warn.mock.calls).toEqual([
    [expect.stringMatching(/is tested with three 0\.185 to 0\.187, and this is r188\. If splats are wrong/)],
  ]);
});

test('the manifests install those that are tested, and refuse none that come', () => {
  const manifest = (path: string) =>
    JSON.parse(readFileSync(new URL(`../../../${path}/package.json`, import.meta.url), 'utf8'));
  for (const path of ['packages/three', 'packages/react']) {
    expect(manifest(path).peerDependencies.three).toBe(`>=0.${oldest}.0`);
    expect(manifest(path).devDependencies.three).toBe(`^0.${newest}.0`);
  }
  expect(manifest('e2e/three/oldest').devDependencies.three).toBe(`0.${oldest}.0`);
});
