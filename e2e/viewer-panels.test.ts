import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { changedPart, colorsIn } from './screenshot.ts';
import {
  CHEAP,
  redraw,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForImage,
  waitForNotice,
} from './viewer-page.ts';

const harness = viewerHarness();

/** The image without the clip's handle. */
const picture = (page: Page) => viewerScreenshot(page, '.clip-gizmo { visibility: hidden !important; }');

/** The smallest in which a panel leaves the middle of the picture free. */
const SIZE = { viewport: { width: 800, height: 490 } };
const effectsIn = (page: Page) => new URL(page.url()).searchParams.get('effects');

describe('effects that are asked for', () => {
  it('are switched, slid, moved by a handle, linked and reset', async () => {
    const page = await harness.openViewer(CHEAP, {
      ...SIZE,
      permissions: ['clipboard-read', 'clipboard-write'],
    });
    await page.keyboard.press('h');
    await redraw(page, () => page.keyboard.press('e'));
    const first = await picture(page);
    const click = (testId: string) => page.getByTestId(testId).click();
    expect(await textOf(page, 'request-highlight')).toContain('Not available: no splats are selected');

    await redraw(page, () => click('switch-clip'));
    const cut = await picture(page);
    expect(changedPart(first, cut, 2)).toBeGreaterThan(0.1);
    await page.waitForURL(/effects=clip:plane:/);
    expect(await textOf(page, 'cost-clip')).toBe('cost not measured');

    // By pointer and by keys, along the plane's normal only.
    const place = () => effectsIn(page)?.split(':').slice(2, 5).map(Number) ?? [];
    const [x, y, z] = place();
    const handle = page.getByTestId('clip-handle');
    const box = await handle.boundingBox();
    if (!box) throw new Error('The handle is not in the picture.');
    await page.mouse.move(box.x + 22, box.y + 22);
    await page.mouse.down();
    await redraw(page, () => page.mouse.move(box.x + 50, box.y + 62));
    await page.mouse.up();
    await expect.poll(() => place()[1]).toBeLessThan(y);
    expect([place()[0], place()[2]]).toEqual([x, z]);
    const dragged = place()[1];
    await redraw(page, () => page.keyboard.press('Shift+ArrowDown'));
    await expect.poll(() => place()[1]).toBeLessThan(dragged);

    await redraw(page, () => click('clip-shape-sphere'));
    const radius = page.getByTestId('clip-radius');
    await radius.focus();
    await redraw(page, () => page.keyboard.press('Home'));
    expect(await radius.getAttribute('aria-valuetext')).toBe('0.000 units');
    expect(changedPart(await picture(page), cut, 2)).toBeGreaterThan(0.1);
    await page.waitForURL(/effects=clip:sphere:/);
    await redraw(page, () => click('reset-clip'));
    await page.waitForURL(/effects=clip:plane:/);
    await redraw(page, () => click('switch-clip'));
    expect(await page.getByTestId('clip-gizmo').count()).toBe(0);

    await redraw(page, () => click('switch-reveal'));
    // Tests ask for less motion.
    expect(await page.getByTestId('play-reveal').isDisabled()).toBe(true);
    await redraw(page, () => click('reveal-from-camera'));
    // As far as the middle of the scene, so that there is something to compare below, and something left out.
    await page.getByTestId('reveal-radius').focus();
    await redraw(page, async () => {
      for (const key of ['Home', 'PageUp', 'PageUp', 'PageUp', 'PageUp']) await page.keyboard.press(key);
    });
    const revealed = await picture(page);
    expect(colorsIn(revealed), 'different colours').toBeGreaterThan(500);
    expect(changedPart(first, revealed, 2)).toBeGreaterThan(0.1);
    await redraw(page, () => click('switch-tint'));
    await redraw(page, () => page.getByTestId('tint-color').fill('#ff8000'));
    await page.waitForURL(/effects=reveal:camera:[^&]*,tint:ff8000(&|$)/);

    // The link shows the same elsewhere.
    await page.keyboard.press('l');
    await waitForNotice(page, 'The link is copied');
    const link = await page.evaluate(() => navigator.clipboard.readText());
    const other = await harness.newPage(SIZE);
    await other.goto(`${link}&noui`);
    await waitForImage(other);
    // The panel has moved the picture aside, and a page without it has not.
    await redraw(page, () => page.keyboard.press('e'));
    const [shown, linked] = [await picture(page), await picture(other)];
    expect(changedPart(revealed, shown, 2)).toBeGreaterThan(0.1);
    expect(colorsIn(shown), 'different colours').toBeGreaterThan(500);
    expect(Buffer.from(linked.data).equals(Buffer.from(shown.data))).toBe(true);

    await redraw(page, () => page.keyboard.press('e'));
    await redraw(page, () => click('reset-effects'));
    await page.waitForURL((url) => !url.searchParams.has('effects'));
    expect(await page.getByTestId('switch-reveal').isChecked()).toBe(false);
    // Keys mean the same on a switch.
    await page.getByTestId('switch-clip').focus();
    await page.keyboard.press('e');
    await page.getByTestId('effects').waitFor({ state: 'detached' });
  });
});
