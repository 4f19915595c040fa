import { readFile } from 'node:fs/promises';
import { readSplats } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { CHEAP, drawnCamera, redraw, textOf, viewerHarness, viewerScreenshot } from './viewer-page.ts';

const { shareViewer } = viewerHarness();

/** Splats of the scene. */
const COUNT = 10_000;

/** Places of marks over the image. */
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

/** Opens the panel on one of its tabs, without the figures, which hide a part of the picture. */
async function openInspect(tab: 'splat' | 'distance' | 'histogram' | 'select' | 'crop', address = CHEAP) {
  const page = await shareViewer(address, { viewport: { width: 660, height: 490 } });
  await page.keyboard.press('h');
  await redraw(page, () => page.keyboard.press('i'));
  await page.getByTestId('inspect').waitFor();
  if (tab !== 'splat') await page.getByTestId(`inspect-tab-${tab}`).click();
  return page;
}

async function drag(page: Page, from: [number, number], to: [number, number]): Promise<void> {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to);
  await page.mouse.up();
}

/** Selects splats in a rectangle, and returns how many. */
async function selectInRectangle(page: Page): Promise<number> {
  await redraw(page, () => drag(page, [120, 250], [240, 350]));
  await expect.poll(() => countIn(page, 'select-count')).toBeGreaterThan(10);
  return countIn(page, 'select-count');
}

/** Saves by the panel that is open, and counts the splats of the file. */
async function savedCount(page: Page): Promise<number> {
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByTestId('save-file').click(),
  ]);
  return (await readSplats(await readFile(await download.path()))).count;
}

describe('inspecting a scene in the viewer', () => {
  it('explains the splat that is clicked, outlines it while the scene turns, and finds it by its row', async () => {
    const page = await openInspect('splat');
    const rowShown = async () => Number((await textOf(page, 'inspect-row')).replace(/\D/g, ''));
    // Another frame, in which the splat itself has another colour.
    await redraw(page, () => page.mouse.click(180, 300));
    await page.getByTestId('inspect-position').waitFor();
    const row = await rowShown();
    expect(row).toBeLessThan(COUNT);
    expect(await page.getByTestId('inspect-colors').locator('tr').count()).toBe(4);
    await expect.poll(() => marks(page, 'circle.mark-line')).not.toEqual([]);
    const [ellipse] = await marks(page, 'circle.mark-line');
    expect(ellipse).toContain('matrix(');
    // A drag turns the scene and inspects nothing else; the outline follows.
    await redraw(page, () => drag(page, [180, 300], [240, 300]));
    expect(await rowShown()).toBe(row);
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
  });

  it('measures a distance, takes a known length for it, and keeps its label in place', async () => {
    const page = await openInspect('distance');
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
  });

  it('counts every splat in a histogram, and marks and selects those of a bar', async () => {
    const page = await openInspect('histogram');
    await page.getByTestId('histogram-opacity').waitFor();
    const table = page.getByTestId('histogram-opacity').locator('details');
    await table.locator('summary').click();
    const counts = await table.locator('td').allTextContents();
    expect(counts.map((count) => Number(count.replaceAll(',', ''))).reduce((a, b) => a + b)).toBe(COUNT);
    await redraw(page, () => page.getByTestId('mark-opacity').press('End'));
    await page
      .getByTestId('histogram-opacity')
      .getByText(`0.95 to 1: ${counts.at(-1)} splats`)
      .waitFor();
    await page.getByTestId('inspect-tab-select').click();
    await page.getByTestId('select-marked').click();
    await page
      .getByTestId('select-count')
      .getByText(`${counts.at(-1)} of 10,000 splats are selected`)
      .waitFor();
  });

  it('selects splats in a rectangle without a turn of the scene, and shows which', async () => {
    const page = await openInspect('select');
    const before = await viewerScreenshot(page);
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
    expect(differing(await viewerScreenshot(page), before)).toBeGreaterThan(1000);
  });

  it('deselects splats under a brush, and undoes that', async () => {
    const page = await openInspect('select');
    const selected = await selectInRectangle(page);
    await page.getByTestId('select-brush').click();
    await page.keyboard.down('Alt');
    await drag(page, [130, 300], [230, 300]);
    await page.keyboard.up('Alt');
    await expect.poll(() => countIn(page, 'select-count')).toBeLessThan(selected);
    await page.getByTestId('undo').click();
    await expect.poll(() => countIn(page, 'select-count')).toBe(selected);
  });

  it('removes what is selected, saves what is left, and brings the removed back, all by keys', async () => {
    const page = await openInspect('select');
    const before = await viewerScreenshot(page);
    const selected = await selectInRectangle(page);
    const removal = page
      .getByTestId('select-count')
      .getByText(`${selected.toLocaleString('en')} splats removed`);
    await redraw(page, () => page.keyboard.press('Delete'));
    await removal.waitFor();
    await redraw(page, () => page.keyboard.press('ControlOrMeta+z'));
    expect(await countIn(page, 'select-count')).toBe(selected);
    await redraw(page, () => page.keyboard.press('ControlOrMeta+Shift+z'));
    await removal.waitFor();
    expect(differing(await viewerScreenshot(page), before)).toBeGreaterThan(1000);
    await page.getByTestId('select-save-left').click();
    await page.getByTestId('save-edited').waitFor();
    expect(await savedCount(page)).toBe(COUNT - selected);
    await page.keyboard.press('i');
    await redraw(page, () => page.getByTestId('undo').click());
    await redraw(page, () => page.getByTestId('select-none').click());
    expect(differing(await viewerScreenshot(page), before)).toBe(0);
  });

  it('crops to a box or to what is around it, and saves what stays', async () => {
    const page = await openInspect('crop');
    const whole = await viewerScreenshot(page);
    await redraw(page, () => page.getByTestId('crop-begin').click());
    await redraw(page, () => page.getByTestId('crop-max-x').press('PageDown'));
    await expect.poll(() => marks(page, '[data-mark=box]')).toHaveLength(2);
    await redraw(page, () => page.getByTestId('crop-max-x-number').fill('0'));
    const cropCount = page.getByTestId('crop-count');
    await cropCount.getByText('splats stay').waitFor();
    const kept = await countIn(page, 'crop-count');
    expect(kept).toBeLessThan(COUNT);
    expect(differing(await viewerScreenshot(page), whole)).toBeGreaterThan(1000);
    await redraw(page, () => page.getByTestId('crop-outside').click());
    await cropCount.getByText(`${(COUNT - kept).toLocaleString('en')} of 10,000 splats stay`).waitFor();
    await page.getByTestId('crop-save').click();
    await page.getByTestId('save-cropped').waitFor();
    expect(await savedCount(page)).toBe(COUNT - kept);

    // The crop outlives its panel, and ends with a click.
    await page.keyboard.press('i');
    await redraw(page, () => page.getByTestId('crop-end').click());
    await expect.poll(() => marks(page, '[data-mark=box]')).toEqual([]);
  });

  it('moves the faces of a crop by handles in the picture, by pointer and by key, and undoes each', async () => {
    const page = await openInspect('crop');
    await redraw(page, () => page.getByTestId('crop-begin').click());
    const maxX = async () => Number(await page.getByTestId('crop-max-x-number').inputValue());
    const begun = await maxX();
    const handle = page.getByTestId('crop-handle-max-x');
    const mark = (await handle.locator('span').boundingBox())!;
    const [x, y] = [mark.x + mark.width / 2, mark.y + mark.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    // Two steps of one drag, towards the middle of the box.
    await redraw(page, () => page.mouse.move(x - 20, y));
    await redraw(page, () => page.mouse.move(x - 40, y));
    await page.mouse.up();
    const dragged = await maxX();
    expect(dragged).toBeLessThan(begun);
    // It has the keyboard now.
    await redraw(page, () => page.keyboard.press('Shift+ArrowRight'));
    expect(await maxX()).toBeGreaterThan(dragged);
    await redraw(page, () => page.keyboard.press('ControlOrMeta+z'));
    expect(await maxX()).toBe(dragged);
    await redraw(page, () => page.getByTestId('undo').click());
    expect(await maxX()).toBe(begun);
  });
});
