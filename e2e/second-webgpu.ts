// The WebGPU of Firefox: wgpu, with naga as compiler. Its tests run on lavapipe, alike everywhere.
import { existsSync } from 'node:fs';
import { findDeno } from '@websplatter/tools/deno';
import { findPuppeteer } from '@websplatter/tools/firefox';
import { findLavapipe } from '@websplatter/tools/vulkan';
import { test } from 'vitest';

export const lavapipe = findLavapipe() ?? '';
export const deno = findDeno() ?? '';
export const puppeteer = findPuppeteer() ?? '';
export const firefox =
  process.env.FIREFOX_PATH ?? ['/usr/bin/firefox-esr', '/usr/bin/firefox'].find(existsSync) ?? '';

/** Whether missing programs fail tests, as `npm test` asks if it can install them. */
const isRequired = process.env.WEBSPLATTER_REQUIRE_SECOND_WEBGPU === '1';

/**
 * `test` for tests that need `programs`, given as paths by name. Where one is missing they are
 * skipped with a printed reason; under `WEBSPLATTER_REQUIRE_SECOND_WEBGPU` the file fails instead.
 */
export function testWith(programs: Readonly<Record<string, string>>): typeof test | typeof test.skip {
  const missing = Object.keys(programs).filter((name) => programs[name] === '');
  if (missing.length === 0) return test;
  const reason = `${missing.join(' and ')} cannot be found: \`npm test\` says how to install what the tests need`;
  if (isRequired) throw new Error(reason);
  console.warn(`Tests are skipped: ${reason}.`);
  return test.skip;
}
