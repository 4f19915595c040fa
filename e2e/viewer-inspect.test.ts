import { readFile } from 'node:fs/promises';
import { readSplats } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { CHEAP, drawnCamera, redraw, textOf, viewerHarness, viewerScreenshot } from './viewer-page.ts';

const { openViewer } = viewerHarness();

/** What is drawn over the image, by its places. */
const marks = (page: Page, selector: string) =>
  page
    .getByTestId('inspect-marks')
    .evaluate((svg, wanted) => [...svg.querySelectorAll(wanted)].map((mark) => mark.outerHTML), selector);

/** The number that a text begins with. */
const countIn = async (page: Page, testId: string) =>
  Number((await textOf(page, testId)).replaceAll(',', '').match(/^\d+/)?.[0]);

/** How many pixels differ between two screenshots. */
function differing(a: { data: Uint8Array }, b: { data: Uint8Array }): number {
  let count = 0;
  for (let i = 0; i < a.data.length; i += 4)
    if (a.data[i] !== b.data[i] || a.data[i + 1] !== b.data[i + 1]) count++;
  return count;
}

describe('inspecting a scene in the viewer', () => {
  it('explains a splat, measures, counts, selects, crops, and saves what is left', async () => {
    const page = await openViewer(CHEAP, { viewport: { width: 660, height: 490 } });
    await page.keyboard.press('h');
    await redraw(page, () => page.keyboard.press('i'));
    await page.getByTestId('inspect').waitFor();
    const whole = await viewerScreenshot(page);
    // Another frame, in which the splat itself has another colour.
    await redraw(page, () => page.mouse.click(180, 300));
    await page.getByTestId('inspect-position').waitFor();
    const row = Number((await textOf(page, 'inspect-row')).replace(/\D/g, ''));
    expect(row).toBeLessThan(10_000);
    expect(await page.getByTestId('inspect-colors').locator('tr').count()).toBe(4);
    await expect.poll(() => marks(page, 'circle.mark-line')).not.toEqual([]);
    const [ellipse] = await marks(page, 'circle.mark-line');
    expect(ellipse).toContain('matrix(');
    // A drag turns the scene and inspects nothing else; the outline follows.
    await redraw(page, async () => {
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
    await page.getByTestId('inspect-problem').getByText('no splat in row 99999').waitFor();
    await page.getByTestId('inspect-row-input').fill(String(row));
    await page.keyboard.press('Enter');
    await page.getByTestId('inspect-position').waitFor();
    expect(await textOf(page, 'inspect-position')).toBe(position);

    await page.getByTestId('inspect-tab-distance').click();
    await page.mouse.click(150, 300);
    await page.getByTestId('ruler-hint').getByText('Click the other end').waitFor();
    await page.mouse.click(250, 330);
    await page.getByTestId('ruler-length').getByText('units').waitFor();
    await page.getByTestId('known-length').fill('2.5');
    await page.getByTestId('set-length').click();
    await page.getByTestId('length-scale').waitFor();
    expect(await textOf(page, 'ruler-length')).toBe('2.5 m');
    await expect.poll(() => marks(page, 'text')).toEqual([expect.stringContaining('2.5 m')]);
    const [label] = await marks(page, 'text');
    await page.keyboard.press('+');
    await expect.poll(() => marks(page, 'text')).not.toEqual([label]);

    await page.getByTestId('inspect-tab-histogram').click();
    await page.getByTestId('histogram-opacity').waitFor();
    const table = page.getByTestId('histogram-opacity').locator('details');
    await table.locator('summary').click();
    const counts = await table.locator('td').allTextContents();
    expect(counts.map((count) => Number(count.replaceAll(',', ''))).reduce((a, b) => a + b)).toBe(10_000);
    await redraw(page, () => page.getByTestId('mark-opacity').press('End'));
    await page
      .getByTestId('histogram-opacity')
      .getByText(`0.95 to 1: ${counts.at(-1)} splats`)
      .waitFor();

    // What is selected is marked; what is removed is not drawn, and comes back.
    await page.getByTestId('inspect-tab-select').click();
    await page.getByTestId('select-marked').click();
    const selectCount = page.getByTestId('select-count');
    await selectCount.getByText(`${counts.at(-1)} of 10,000 splats are selected`).waitFor();
    await redraw(page, () => page.getByTestId('select-none').click());
    const turned = await viewerScreenshot(page);
    const camera = await drawnCamera(page);
    await page.mouse.move(120, 250);
    await page.mouse.down();
    await page.mouse.move(240, 350);
    expect(await marks(page, '[data-mark=region]')).toHaveLength(3);
    await redraw(page, () => page.mouse.up());
    expect(await marks(page, '[data-mark=region]')).toEqual([]);
    // The drag has turned nothing.
    expect(await drawnCamera(page)).toEqual(camera);
    await expect.poll(() => countIn(page, 'select-count')).toBeGreaterThan(10);
    const selected = await countIn(page, 'select-count');
    expect(differing(await viewerScreenshot(page), turned)).toBeGreaterThan(1000);
    await page.getByTestId('select-brush').click();
    await page.keyboard.down('Alt');
    await page.mouse.move(130, 300);
    await page.mouse.down();
    await page.mouse.move(230, 300);
    await page.mouse.up();
    await page.keyboard.up('Alt');
    await expect.poll(() => countIn(page, 'select-count')).toBeLessThan(selected);
    await page.getByTestId('select-undo').click();
    await expect.poll(() => countIn(page, 'select-count')).toBe(selected);
    await redraw(page, () => page.getByTestId('select-remove').click());
    await selectCount.getByText(`${selected.toLocaleString('en')} splats removed`).waitFor();
    expect(differing(await viewerScreenshot(page), turned)).toBeGreaterThan(1000);
    await page.getByTestId('select-save-left').click();
    await page.getByTestId('save-edited').waitFor();
    const [left] = await Promise.all([page.waitForEvent('download'), page.getByTestId('save-file').click()]);
    expect((await readSplats(await readFile(await left.path()))).count).toBe(10_000 - selected);
    await page.keyboard.press('i');
    await redraw(page, () => page.getByTestId('select-undo').click());
    await redraw(page, () => page.getByTestId('select-none').click());
    expect(differing(await viewerScreenshot(page), turned)).toBe(0);

    await page.getByTestId('inspect-tab-crop').click();
    await redraw(page, () => page.getByTestId('crop-begin').click());
    await redraw(page, () => page.getByTestId('crop-max-x').press('PageDown'));
    await expect.poll(() => marks(page, '[data-mark=box]')).toHaveLength(2);
    await redraw(page, () => page.getByTestId('crop-max-x-number').fill('0'));
    const cropCount = page.getByTestId('crop-count');
    await cropCount.getByText('splats stay').waitFor();
    const kept = await countIn(page, 'crop-count');
    expect(kept).toBeLessThan(10_000);
    expect(differing(await viewerScreenshot(page), whole)).toBeGreaterThan(1000);
    await redraw(page, () => page.getByTestId('crop-outside').click());
    await cropCount.getByText(`${(10_000 - kept).toLocaleString('en')} of 10,000 splats stay`).waitFor();

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
    await redraw(page, () => page.getByTestId('crop-end').click());
    await expect.poll(() => marks(page, '[data-mark=box]')).toEqual([]);
  });
});
