import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { encodePly } from '@websplatter/core';
import type { AxeResults } from 'axe-core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { testScene } from './test-scene.ts';
import { CHEAP, dropFiles, textOf, viewerHarness, waitForScene, waitForState } from './viewer-page.ts';

const harness = viewerHarness();
const { openViewer } = harness;
const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

const MAP_MODES = ['tile-cost', 'pixel-cost', 'contribution'];

/** What axe-core finds wrong with the page as it is, in words. */
async function violations(page: Page): Promise<string[]> {
  const { violations: found } = await page.evaluate(() => {
    const { axe } = window as unknown as { axe: { run: (options: object) => Promise<AxeResults> } };
    return axe.run({ resultTypes: ['violations'] });
  });
  return found.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join(' | ')}`);
}

/** Expects no violation in the light and in the dark theme. */
async function expectAccessible(page: Page, state: string): Promise<void> {
  for (const colorScheme of ['light', 'dark'] as const) {
    await page.emulateMedia({ colorScheme });
    expect(await violations(page), `${state}, ${colorScheme}`).toEqual([]);
  }
}

/** Goes on to the modes that lay a map over the picture, and back to the picture itself. */
async function expectMapsAccessible(page: Page): Promise<void> {
  const goTo = async (mode: string) => {
    const isThere = () => new URL(page.url()).searchParams.get('mode') === mode;
    while (!isThere()) {
      const before = page.url();
      await page.keyboard.press('m');
      await page.waitForURL((url) => url.href !== before);
    }
  };
  for (const mode of MAP_MODES) {
    await goTo(mode);
    await page.getByTestId('map-notes').waitFor();
    await expectAccessible(page, mode);
  }
  await page.keyboard.press('m');
  await page.getByTestId('mode-legend').waitFor({ state: 'detached' });
}

describe('the viewer, to people who see, hear or point otherwise', () => {
  it('has nothing that axe-core finds wrong, in any of its main states', async () => {
    const page = await openViewer(CHEAP, { viewport: { width: 900, height: 600 } });
    await page.evaluate(AXE);
    await expectAccessible(page, 'at first');
    for (let presses = 0; presses < 3; presses++) await page.keyboard.press('m');
    await page.getByTestId('mode-scale').waitFor();
    await expectAccessible(page, 'a view mode');
    await expectMapsAccessible(page);
    await page.keyboard.press('c');
    for (const tab of ['measure', 'settings', 'compare']) {
      await page.getByTestId(`accuracy-tab-${tab}`).click();
      await expectAccessible(page, tab);
    }
    await page.getByTestId('compare-split').click();
    await page.getByTestId('split-line').waitFor();
    await expectAccessible(page, 'split image');
    await page.getByTestId('compare-error').click();
    await page.getByTestId('error-max').getByText('Largest').waitFor();
    await expectAccessible(page, 'error map');
    await page.setViewportSize({ width: 360, height: 640 });
    await expectAccessible(page, 'a phone');
    await page.getByTestId('more').click();
    await expectAccessible(page, 'the menu of a phone');
    await page.keyboard.press('Escape');
    for (const [key, name, ...switches] of [
      ['e', 'effects', 'switch-clip', 'switch-reveal', 'switch-fog'],
      ['i', 'inspect'],
      ['x', 'save'],
      ['n', 'clouds'],
      ['?', 'help'],
    ]) {
      await page.keyboard.press(key);
      await page.getByTestId(name).waitFor();
      for (const each of switches) await page.getByTestId(each).click();
      await expectAccessible(page, name);
    }
    await page.keyboard.press('Escape');
    await page.keyboard.press('i');
    await page.getByTestId('inspect-tab-select').click();
    await page.getByTestId('select-brush').click();
    await expectAccessible(page, 'selecting');
    await dropFiles(page, [{ name: 'cut.ply', bytes: new TextEncoder().encode('ply\nthat ends') }]);
    await waitForState(page, 'error');
    await expectAccessible(page, 'an error');
  });

  it('keeps swatches and what is pressed apart where the system chooses the colours', async () => {
    const page = await openViewer(CHEAP, { viewport: { width: 900, height: 600 }, forcedColors: 'active' });
    const backgrounds = (selectors: readonly string[]) =>
      page.evaluate(
        (list) => list.map((each) => getComputedStyle(document.querySelector(each)!).backgroundColor),
        selectors,
      );
    const swatches = await backgrounds([
      'dt .stage-preprocess',
      'dt .stage-sort',
      'dt .stage-rasterize',
      '.hud',
    ]);
    expect(new Set(swatches).size).toBe(4);
    const [pressed, released] = await backgrounds([
      '[data-testid=command-hud]',
      '[data-testid=command-accuracy]',
    ]);
    expect(pressed).not.toBe(released);
  });
});

describe('the pages beside the viewer', () => {
  it.each([
    ['a hard case', '?scene=hard&case=scale-zero-all', 'case-legend'],
    ['the hard cases on a device', '?conformance&cases=scale-unti', 'conformance-failure'],
    ['the benchmark', '?bench&size=9', 'bench-failure'],
  ])('have nothing that axe-core finds wrong: %s', async (name, address, testId) => {
    const page = await harness.open(address);
    await page.getByTestId(testId).waitFor();
    await page.evaluate(AXE);
    await expectAccessible(page, name);
  });
});

describe('the gallery of hard cases', () => {
  it('has nothing that axe-core finds wrong, shows a refused file on a page of its own, and opens what is dropped', async () => {
    const page = await harness.open('?scene=hard&q=truncated');
    await page.getByTestId('gallery').waitFor();
    await page.evaluate(AXE);
    await expectAccessible(page, 'gallery');
    await page.locator('[data-case=input-truncated]').click();
    await page
      .getByTestId('case-refusal')
      .getByText(/^Refused/)
      .waitFor();
    await expectAccessible(page, 'a refused file');
    await page.getByTestId('case-open').click();
    await waitForState(page, 'error');
    expect(await textOf(page, 'scene-title')).toBe('input-truncated');
    expect(await textOf(page, 'scene')).toContain('No splats');
    expect(await textOf(page, 'error')).toContain('incomplete');
    await page.getByRole('link', { name: 'All hard cases' }).click();

    await page.getByTestId('gallery').waitFor();
    await dropFiles(page, [{ name: 'dropped.ply', bytes: encodePly(testScene()) }], undefined, 'gallery');
    await waitForScene(page, 'dropped.ply');
    expect(await textOf(page, 'scene-title')).toBe('dropped.ply');
    expect(new URL(page.url()).search).toBe('');
    // Files have y down and are turned; the button tells of what a person does.
    const flip = page.getByTestId('command-flip');
    expect(await flip.getAttribute('aria-pressed')).toBe('false');
    await page.keyboard.press('u');
    expect(await flip.getAttribute('aria-pressed')).toBe('true');
    await page.goBack();
    await page.getByTestId('gallery').waitFor();
  });
});
