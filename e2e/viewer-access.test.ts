// Proves: axe-core in all main states: windows of four sizes, light, dark, forced colours.
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { AXE, expectAccessible } from './accessible.ts';
import {
  CHEAP,
  dropFiles,
  loseDeviceOnDemand,
  showFigures,
  viewerHarness,
  waitForImage,
  waitForState,
} from './viewer-page.ts';

const harness = viewerHarness();

const WIDE = { viewport: { width: 900, height: 600 } };
const PHONE = { viewport: { width: 360, height: 640 } };
/** View modes, each with a sign of it. */
const MODES = [
  ['opacity', 'mode-scale'],
  ['tile-cost', 'map-notes'],
  ['pixel-cost', 'map-notes'],
  ['contribution', 'map-notes'],
] as const;

async function openPanel(page: Page, key: string, testId: string): Promise<void> {
  await page.keyboard.press(key);
  await page.getByTestId(testId).waitFor();
}

/** Prepares a page for `expectAccessible`, whose windows are large: axe-core reads no pixel, so the canvas has few. */
async function audit(page: Page): Promise<void> {
  await page.evaluate(() => Object.defineProperty(window, 'devicePixelRatio', { value: 0.25 }));
  await page.evaluate(AXE);
}

describe('the viewer, to people who see, hear or point otherwise', () => {
  const openAudited = async (options: typeof WIDE) => {
    const page = await harness.shareViewer(CHEAP, options);
    await audit(page);
    return page;
  };

  it('has nothing that axe-core finds wrong at first, nor in its view modes', async () => {
    const page = await openAudited(WIDE);
    await expectAccessible(page, 'at first');
    for (const [mode, testId] of MODES) {
      while (new URL(page.url()).searchParams.get('mode') !== mode) {
        const before = page.url();
        await page.keyboard.press('m');
        await page.waitForURL((url) => url.href !== before);
      }
      await page.getByTestId(testId).waitFor();
      await expectAccessible(page, mode);
    }
  });

  it('has nothing that axe-core finds wrong in the tabs of its accuracy, while it compares settings, nor with its menu', async () => {
    const page = await openAudited(WIDE);
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
    await page.setViewportSize(PHONE.viewport);
    await page.getByTestId('more').click();
    await expectAccessible(page, 'menu');
  });

  it('has nothing that axe-core finds wrong while splats are inspected, selected and cropped', async () => {
    const page = await openAudited(PHONE);
    await openPanel(page, 'i', 'inspect');
    await expectAccessible(page, 'inspecting');
    await page.getByTestId('inspect-tab-select').click();
    for (const tool of ['brush', 'polygon', 'sphere', 'color']) {
      await page.getByTestId(`select-${tool}`).click();
      await expectAccessible(page, `selecting by ${tool}`);
    }
    await page.getByTestId('inspect-tab-crop').click();
    await expectAccessible(page, 'before a crop');
    await page.getByTestId('crop-begin').click();
    await page.getByTestId('crop-to-subject').click();
    await page.getByTestId('crop-handle-max-x').waitFor();
    await expectAccessible(page, 'cropping');
  });

  it('has nothing that axe-core finds wrong in the panels of the view, to save, of files, effects and keys, on foot, nor with an error', async () => {
    const page = await openAudited(PHONE);
    for (const [key, name] of [
      ['v', 'view'],
      ['x', 'save'],
      ['n', 'clouds'],
      ['b', 'travel'],
      ['?', 'help'],
      ['e', 'effects'],
    ]) {
      await openPanel(page, key, name);
      if (name === 'effects')
        for (const each of ['volumes', 'reveal', 'fog']) await page.getByTestId(`switch-${each}`).click();
      await expectAccessible(page, name);
      if (name === 'help') await page.keyboard.press('Escape');
    }
    await page.keyboard.press('Escape');
    await dropFiles(page, [{ name: 'cut.ply', bytes: new TextEncoder().encode('ply\nthat ends') }]);
    await waitForState(page, 'error');
    await expectAccessible(page, 'an error');
  });

  it('has nothing that axe-core finds wrong where scenes are opened and sent on, nor in what is sent', async () => {
    const page = await openAudited(PHONE);
    await openPanel(page, 'o', 'address');
    await expectAccessible(page, 'opening');
    await openPanel(page, 'x', 'save');
    for (const tab of ['share', 'picture', 'file']) {
      await page.getByTestId(`save-tab-${tab}`).click();
      await expectAccessible(page, `saving: ${tab}`);
    }
    await page.goto(`${harness.server.url}${CHEAP}&noui&annotation=0:0.2:0,0,0.2,0,2,0,1.4,words:The+vase`);
    await page.getByTestId('plain-controls').waitFor();
    await audit(page);
    await expectAccessible(page, 'controls of a picture alone');
  });

  it('has nothing that axe-core finds wrong where there is no GPU, or no longer', async () => {
    const without = await harness.newPage(PHONE);
    await without.addInitScript(() => Object.defineProperty(navigator, 'gpu', { value: undefined }));
    await without.goto(harness.server.url);
    await without.getByTestId('webgpu-unavailable').waitFor();
    await without.evaluate(AXE);
    await expectAccessible(without, 'no GPU');

    const page = await harness.newPage(PHONE);
    await page.addInitScript(loseDeviceOnDemand);
    await page.goto(`${harness.server.url}${CHEAP}`);
    await waitForImage(page);
    // There is no other.
    await page.evaluate(() => {
      GPU.prototype.requestAdapter = async () => null;
      dispatchEvent(new Event('lose-device'));
    });
    await page.getByTestId('device-lost').waitFor();
    await audit(page);
    await expectAccessible(page, 'lost GPU');
  });

  it('keeps swatches and what is pressed apart where the system chooses the colours', async () => {
    const page = await harness.openViewer(CHEAP, { ...WIDE, forcedColors: 'active' });
    await showFigures(page);
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
    await page.keyboard.press('c');
    await page.getByTestId('accuracy').waitFor();
    const [pressed, released] = await backgrounds([
      '[data-testid=command-accuracy]',
      '[data-testid=command-effects]',
    ]);
    expect(pressed).not.toBe(released);
  });
});
