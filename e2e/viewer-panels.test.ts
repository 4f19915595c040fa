import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { changedPart, type Screenshot } from './screenshot.ts';
import {
  frameCount,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForFrameAfter,
  waitForImage,
} from './viewer-page.ts';

const harness = viewerHarness();
/** Cheap, and by a rasteriser that does not follow from times: images are compared bit for bit. */
const CHEAP = '?scene=still-life-small&accuracy=fast,shDegree:0,resolutionScale:0.25,rasterizer:tiles';
/** Nothing but the canvas. */
const WITHOUT_HANDLE = '.clip-gizmo { visibility: hidden !important; }';

/** Does something that changes the image, and returns the new one. */
async function redrawn(page: Page, act: () => Promise<unknown>): Promise<Screenshot> {
  const frames = await frameCount(page);
  await act();
  await waitForFrameAfter(page, frames);
  return viewerScreenshot(page, WITHOUT_HANDLE);
}

const effectsIn = (page: Page) => new URL(page.url()).searchParams.get('effects');

describe('effects that are asked for', () => {
  it('are switched, slid, moved by a handle, linked and reset', async () => {
    const page = await harness.openViewer(CHEAP, {
      viewport: { width: 900, height: 500 },
      permissions: ['clipboard-read', 'clipboard-write'],
    });
    const first = await viewerScreenshot(page);
    await page.keyboard.press('h');
    await page.keyboard.press('e');
    const click = (testId: string) => page.getByTestId(testId).click();
    expect(await textOf(page, 'request-highlight')).toContain('Not available: no splats are selected');

    const cut = await redrawn(page, () => click('switch-clip'));
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
    const lower = await redrawn(page, () => page.mouse.move(box.x + 50, box.y + 62));
    await page.mouse.up();
    expect(changedPart(cut, lower, 2)).toBeGreaterThan(0.01);
    await expect.poll(() => place()[1]).toBeLessThan(y);
    expect([place()[0], place()[2]]).toEqual([x, z]);
    const dragged = place()[1];
    await redrawn(page, () => page.keyboard.press('Shift+ArrowDown'));
    await expect.poll(() => place()[1]).toBeLessThan(dragged);

    await redrawn(page, () => click('clip-shape-sphere'));
    const radius = page.getByTestId('clip-radius');
    await radius.focus();
    const empty = await redrawn(page, () => page.keyboard.press('Home'));
    expect(await radius.getAttribute('aria-valuetext')).toBe('0.000 units');
    expect(changedPart(empty, lower, 2)).toBeGreaterThan(0.05);
    await redrawn(page, () => click('reset-clip'));
    await page.waitForURL(/effects=clip:plane:/);

    await redrawn(page, () => click('switch-tint'));
    await redrawn(page, () => page.getByTestId('tint-color').fill('#ff8000'));
    await click('switch-reveal');
    // Tests ask for less motion.
    expect(await page.getByTestId('play-reveal').isDisabled()).toBe(true);
    await redrawn(page, () => click('reveal-from-camera'));
    await redrawn(page, () => click('switch-clip'));
    const tinted = await redrawn(page, () => click('switch-reveal'));
    await page.waitForURL(/effects=tint:ff8000(&|$)/);

    // The link shows the same elsewhere.
    await page.keyboard.press('l');
    await page.getByTestId('notice').getByText('copied').waitFor();
    const link = await page.evaluate(() => navigator.clipboard.readText());
    const other = await harness.newPage({ viewport: { width: 900, height: 500 } });
    await other.goto(`${link}&noui`);
    await waitForImage(other);
    const linked = await viewerScreenshot(other);
    expect(Buffer.from(linked.data).equals(Buffer.from(tinted.data))).toBe(true);

    await click('switch-clip');
    await redrawn(page, () => click('reset-effects'));
    await page.waitForURL((url) => !url.searchParams.has('effects'));
    expect(await page.getByTestId('switch-clip').isChecked()).toBe(false);
    expect(await page.getByTestId('clip-gizmo').count()).toBe(0);
    // Keys mean the same on a switch.
    await page.getByTestId('switch-clip').focus();
    await page.keyboard.press('e');
    await page.getByTestId('effects').waitFor({ state: 'detached' });
  });

  it('are refused with a reason where the address cannot be read', async () => {
    const page = await harness.openViewer(`${CHEAP}&effects=fog:depths:3:1:c8d0dc`, {
      viewport: { width: 160, height: 120 },
    });
    await page.getByTestId('notice').getByText('far is 1').waitFor({ state: 'attached' });
    await page.waitForURL((url) => !url.searchParams.has('effects'));
  });
});
