import { describe, expect, it } from 'vitest';
import { CHEAP, redraw, viewerHarness, waitForImage } from './viewer-page.ts';

const harness = viewerHarness();
const WINDOW = { viewport: { width: 480, height: 320 } };

describe('stories in the viewer', () => {
  it('have views with names, which a link brings to another browser', async () => {
    const page = await harness.openViewer(CHEAP, WINDOW);
    await redraw(page, () => page.keyboard.press('v'));
    await page.getByTestId('save-view').click();
    await page.getByTestId('saved-view-name-1').fill('The jug, from above');
    await redraw(page, () => page.keyboard.press('Escape'));
    await redraw(page, () => page.keyboard.press('ArrowLeft'));
    await redraw(page, () => page.keyboard.press('v'));
    await page.getByTestId('save-view').click();
    await page.getByTestId('saved-view-2').waitFor();
    await page.waitForURL(/[?&]view=[^&]*,name:The\+jug,\+from\+above&view=/);
    const address = page.url();

    const other = await harness.newPage(WINDOW);
    await other.goto(address);
    await waitForImage(other);
    await redraw(other, () => other.keyboard.press('v'));
    const names = other.getByTestId('saved-views').getByRole('textbox');
    await expect
      .poll(() => names.evaluateAll((fields) => fields.map((field) => (field as HTMLInputElement).value)))
      .toEqual(['The jug, from above', '']);
    // Links have no small images: they are drawn here.
    const widthPx = () =>
      other
        .getByTestId('saved-view-1')
        .locator('canvas')
        .evaluate((c: HTMLCanvasElement) => c.width);
    await expect.poll(widthPx).toBe(144);
  });
});
