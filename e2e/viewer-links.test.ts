// Proves: a link shows the same picture in another window, bit for bit.
import { readFile } from 'node:fs/promises';
import { encodePly } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { decodePng } from './png.ts';
import { changedPart, type Screenshot } from './screenshot.ts';
import { testScene } from './test-scene.ts';
import {
  drawnCamera,
  dropFiles,
  redraw,
  SMALL,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForImage,
  waitForNotice,
  waitForScene,
} from './viewer-page.ts';

/** Cheap, and by a rasteriser that does not follow from times: images are compared bit for bit. */
const CHEAP = '?scene=still-life-small&accuracy=fast,resolutionScale:0.5,rasterizer:tiles';
const CROP = 'crop=-0.1:-2:-1e3:2:2:1000:inside';

const harness = viewerHarness();

const isSame = (a: Screenshot, b: Screenshot) => Buffer.from(a.data).equals(Buffer.from(b.data));

/** For `addInitScript`: notes on the document that an image was shown before any picture. */
function notePoster(): void {
  new MutationObserver(() => {
    if (document.querySelector('.poster')) document.documentElement.dataset.poster = 'seen';
  }).observe(document, { childList: true, subtree: true });
}

describe('links of the viewer', () => {
  it('show the same picture in another window, bit for bit', async () => {
    const page = await harness.shareViewer(`${CHEAP}&${CROP}`, {
      permissions: ['clipboard-read', 'clipboard-write'],
    });
    const first = await viewerScreenshot(page);
    await redraw(page, async () => {
      for (const key of ['ArrowLeft', 'ArrowUp', '+', 'w', 'u']) await page.keyboard.press(key);
    });
    await page.waitForURL(/[?&]camera=[^&]*,flipped:1/);
    const moved = await viewerScreenshot(page);
    expect(isSame(moved, first)).toBe(false);

    await page.keyboard.press('l');
    await waitForNotice(page, 'The link is copied');
    const link = await page.evaluate(() => navigator.clipboard.readText());
    expect(link).toContain('accuracy=fast,rasterizer:tiles,resolutionScale:0.5');
    expect(link).toContain('crop=-0.1:-2:-1000:2:2:1000:inside');

    // As it is embedded: without the interface, whose keys do nothing but move the camera.
    const other = await harness.newPage();
    await other.addInitScript(notePoster);
    await other.route('**/poster.svg', (route) =>
      route.fulfill({ body: '<svg xmlns="http://www.w3.org/2000/svg" />', contentType: 'image/svg+xml' }),
    );
    await other.goto(`${link}&noui&poster=poster.svg`);
    await waitForImage(other);
    expect(await other.locator('html').getAttribute('data-poster')).toBe('seen');
    expect(await other.locator('.poster').count()).toBe(0);
    expect(await drawnCamera(other)).toEqual(await drawnCamera(page));
    expect(isSame(await viewerScreenshot(other), moved)).toBe(true);
    expect(await other.getByTestId('toolbar').count()).toBe(0);
    for (const key of ['Escape', '?', 'x', 'h']) await other.keyboard.press(key);
    await redraw(other, () => other.keyboard.press('u'));
    expect(await other.getByTestId('save').count()).toBe(0);

    // A file of this device cannot be linked, and its camera is no other scene's.
    await dropFiles(page, [{ name: 'own.ply', bytes: encodePly(testScene()) }]);
    await waitForScene(page, 'own.ply');
    await page.waitForURL((url) => !/camera|scene|crop/.test(url.search));
    await page.keyboard.press('l');
    await waitForNotice(page, 'only on your device');
    const alone = await viewerScreenshot(page);
    await redraw(page, () => page.keyboard.press('x'));
    expect(await textOf(page, 'save')).toContain('only on your device');
    expect(changedPart(await viewerScreenshot(page), alone)).toBeGreaterThan(0.1);

    // As it is without the panel.
    await page.getByTestId('save-tab-picture').click();
    const downloading = page.waitForEvent('download');
    await page.getByTestId('save-picture').click();
    const download = await downloading;
    expect(download.suggestedFilename()).toBe('own.png');
    const picture = decodePng(await readFile(await download.path()));
    expect(changedPart(picture, alone)).toBe(0);
  });

  it('show the whole scene instead of an impossible camera', async () => {
    const expected = await viewerScreenshot(await harness.shareViewer(CHEAP, SMALL));
    for (const [camera, notice] of [
      ['1e308,-1e308,0,1e308,0,1', 'is no number of float32'],
      ['0,0,0,1e-320,0,1', 'The view cannot be shown'],
      ['0,0,0,2,0,1e-20', 'The view cannot be shown'],
      ['0,0,0,2,0,1,fov:1e-300', 'The view cannot be shown'],
    ]) {
      const page = await harness.shareViewer(`${CHEAP}&camera=${camera}`, SMALL);
      await waitForNotice(page, notice);
      expect(isSame(await viewerScreenshot(page), expected), camera).toBe(true);
    }
  });
});
