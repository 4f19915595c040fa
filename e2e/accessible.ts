import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import type { AxeResults } from 'axe-core';
import type { Page } from 'playwright-core';
import { expect } from 'vitest';

const THEMES = [
  ['light', 'active'],
  ['dark', 'active'],
  ['dark', 'none'],
] as const;
/** Rules that read colours: the others have the same to say in each theme. */
const COLOR_RULES = ['color-contrast', 'link-in-text-block'];

/** axe-core, to be evaluated in a page before functions that use it. */
export const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** Faults that axe-core finds in the page as it is, in words. */
async function violations(page: Page, rules: readonly string[] | null = null): Promise<string[]> {
  const { violations: found } = await page.evaluate((runOnly) => {
    const { axe } = window as unknown as { axe: { run: (options: object) => Promise<AxeResults> } };
    return axe.run({ resultTypes: ['violations'], ...(runOnly && { runOnly }) });
  }, rules);
  return found.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join(' | ')}`);
}

/** Windows from a phone, upright and on its side, to a desk, CSS pixels. */
const SIZES = [
  { width: 360, height: 640 },
  { width: 640, height: 360 },
  { width: 900, height: 600 },
  { width: 1440, height: 900 },
];

/**
 * Expects no violation in a window of each size, nor, in its own, in the light and the dark theme and
 * in colours of the system.
 */
export async function expectAccessible(page: Page, state: string): Promise<void> {
  const own = page.viewportSize();
  if (!own) throw new Error('The page has no size of its own.');
  // The theme is the light one unless a browser is told otherwise.
  const isOwn = ({ width, height }: typeof own) => width === own.width && height === own.height;
  for (const size of [...SIZES.filter((size) => !isOwn(size)), own]) {
    await page.setViewportSize(size);
    expect(await violations(page), `${state}, ${size.width}×${size.height}`).toEqual([]);
  }
  for (const [colorScheme, forcedColors] of THEMES) {
    await page.emulateMedia({ colorScheme, forcedColors });
    expect(
      await violations(page, COLOR_RULES),
      `${state}, ${colorScheme}, forced colours ${forcedColors}`,
    ).toEqual([]);
  }
  await page.emulateMedia({ colorScheme: null, forcedColors: null });
}
