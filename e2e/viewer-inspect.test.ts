import { readFile } from 'node:fs/promises';
import { readSplats } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { frameCount, textOf, viewerHarness, viewerScreenshot, waitForFrameAfter } from './viewer-page.ts';

const { openViewer } = viewerHarness();
const CHEAP = '?scene=still-life-small&accuracy=fast,shDegree:0,resolutionScale:0.25,rasterizer:quads';

/** Does something that changes the image, and waits for the image that follows. */
async function draw(page: Page, act: () => Promise<unknown>): Promise<void> {
  const frames = await frameCount(page);
  await act();
  await waitForFrameAfter(page, frames);
}

/** What is drawn over the image, by its places. */
const marks = (page: Page, selector: string) =>
  page
    .getByTestId('inspect-marks')
    .evaluate((svg, wanted) => [...svg.querySelectorAll(wanted)].map((mark) => mark.outerHTML), selector);

/** How many pixels differ between two screenshots. */
function differing(a: { data: Uint8Array }, b: { data: Uint8Array }): number {
  let count = 0;
  for (let i = 0; i < a.data.length; i += 4)
    if (a.data[i] !== b.data[i] || a.data[i + 1] !== b.data[i + 1]) count++;
  return count;
}

describe('inspecting a scene in the viewer', () => {
  it('explains a splat, measures, counts, crops, and saves what is left', async () => {
    const page = await openViewer(CHEAP, { viewport: { width: 660, height: 490 } });
    await page.keyboard.press('h');
    const whole = await viewerScreenshot(page);

    await page.keyboard.press('i');
    await page.getByTestId('inspect').waitFor();
    // Another frame, in which the splat itself has another colour.
    await draw(page, () => page.mouse.click(180, 300));
    await page.getByTestId('inspect-position').waitFor();
    const row = Number((await textOf(page, 'inspect-row')).replace(/\D/g, ''));
    expect(row).toBeLessThan(10_000);
    expect(await page.getByTestId('inspect-colors').locator('tr').count()).toBe(4);
    const [ellipse] = await marks(page, 'circle.mark-line');
    expect(ellipse).toContain('matrix(');
    // A drag turns the scene and inspects nothing else; the outline follows.
    await draw(page, async () => {
      await page.mouse.move(180, 300);
      await page.mouse.down();
      await page.mouse.move(240, 300);
      await page.mouse.up();
    });
    expect(Number((await textOf(page, 'inspect-row')).replace(/\D/g, ''))).toBe(row);
    await expect.poll(() => marks(page, 'circle.mark-line')).not.toEqual([ellipse]);
    // The same splat by its row.
    const position = await textOf(page, 'inspect-position');
    await page.getByTestId('inspect-row-input').fill('99999');
    await page.keyboard.press('Enter');
    await page.getByText('no splat in row 99999').waitFor();
    await page.getByTestId('inspect-row-input').fill(String(row));
    await page.keyboard.press('Enter');
    await page.getByTestId('inspect-position').waitFor();
    expect(await textOf(page, 'inspect-position')).toBe(position);

    await page.getByTestId('inspect-tab-distance').click();
    await page.mouse.click(150, 300);
    await page.getByText('Click the other end').waitFor();
    await page.mouse.click(250, 330);
    await page.getByTestId('ruler-length').getByText('units').waitFor();
    await page.getByTestId('known-length').fill('2.5');
    await page.getByTestId('set-length').click();
    await page.getByTestId('length-scale').waitFor();
    expect(await textOf(page, 'ruler-length')).toBe('2.5 m');
    const [label] = await marks(page, 'text');
    expect(label).toContain('2.5 m');
    await page.keyboard.press('+');
    await expect.poll(() => marks(page, 'text')).not.toEqual([label]);

    await page.getByTestId('inspect-tab-histogram').click();
    await page.getByTestId('histogram-opacity').waitFor();
    const table = page.getByTestId('histogram-opacity').locator('details');
    await table.locator('summary').click();
    const counts = await table.locator('td').allTextContents();
    expect(counts.map((count) => Number(count.replaceAll(',', ''))).reduce((a, b) => a + b)).toBe(10_000);
    await draw(page, () => page.getByTestId('mark-opacity').press('End'));
    await page.getByText(`0.95 to 1: ${counts.at(-1)} splats`).waitFor();

    await draw(page, () => page.getByTestId('inspect-tab-crop').click());
    await draw(page, () => page.getByTestId('crop-begin').click());
    await page.getByTestId('crop-max-x').press('PageDown');
    expect(await marks(page, '[data-mark=box]')).toHaveLength(2);
    await draw(page, () => page.getByTestId('crop-max-x-number').fill('0'));
    await page.getByText('splats stay').waitFor();
    const kept = Number((await textOf(page, 'crop-count')).replaceAll(',', '').match(/^\d+/)?.[0]);
    expect(kept).toBeLessThan(10_000);
    expect(differing(await viewerScreenshot(page), whole)).toBeGreaterThan(1000);
    await draw(page, () => page.getByTestId('crop-outside').click());
    await page.getByText(`${(10_000 - kept).toLocaleString('en')} of 10,000 splats stay`).waitFor();

    await page.getByTestId('crop-save').click();
    await page.getByTestId('save-cropped').waitFor();
    const [download] = await Promise.all([
      page.waitForEvent('download'),
      page.getByTestId('save-file').click(),
    ]);
    const saved = await readSplats(await readFile(await download.path()));
    expect(saved.count).toBe(10_000 - kept);

    // The crop outlives its panel, and ends with a click.
    await page.keyboard.press('i');
    await draw(page, () => page.getByTestId('crop-end').click());
    expect(await marks(page, '[data-mark=box]')).toEqual([]);
  });
});
