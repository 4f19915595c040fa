import { encodePly } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { AXE, expectAccessible } from './accessible.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  dropFiles,
  redraw,
  textOf,
  viewerHarness,
  waitForImage,
  waitForNotice,
  waitForScene,
} from './viewer-page.ts';

const harness = viewerHarness();
/** Each turns by 5 degrees. */
const HALF_TURN_KEYS = 36;
/** Messages leave the middle of the picture free. */
const LARGE = { viewport: { width: 700, height: 500 } };
const WINDOW = { viewport: { width: 480, height: 320 } };

/** For `addInitScript`: notes for each picture of the canvas where the first marker was over it. */
function notePlaces(): void {
  const places: string[][] = [[]];
  Object.assign(window, { places });
  const draw = GPUCanvasContext.prototype.getCurrentTexture;
  GPUCanvasContext.prototype.getCurrentTexture = function () {
    places.push([]);
    return draw.call(this);
  };
  const note = () => {
    const marker = document.querySelector<HTMLElement>('[data-testid=annotation-1]');
    const place = marker?.style.translate;
    const last = places[places.length - 1];
    if (place && !last.includes(place)) last.push(place);
    requestAnimationFrame(note);
  };
  note();
}

/**
 * Opens the page's address, and `more` parameters, in a shared window of a browser that has kept nothing, into which the
 * page cannot write while it is left either.
 */
async function openElsewhere(page: Page, options: typeof WINDOW, more = ''): Promise<Page> {
  const { search } = new URL(page.url());
  await page.goto('about:blank');
  return harness.shareViewer(`${search}${more}`, options);
}

describe('stories in the viewer', () => {
  it('have views with names, which a link brings to another browser', async () => {
    const page = await harness.shareViewer(CHEAP, WINDOW);
    await redraw(page, () => page.keyboard.press('v'));
    await page.getByTestId('save-view').click();
    await page.getByTestId('saved-view-name-1').fill('The jug, from above');
    await redraw(page, () => page.keyboard.press('Escape'));
    await redraw(page, () => page.keyboard.press('ArrowLeft'));
    await redraw(page, () => page.keyboard.press('v'));
    await page.getByTestId('save-view').click();
    await page.getByTestId('saved-view-2').waitFor();
    await page.waitForURL(/[?&]view=[^&]*,name:The\+jug,\+from\+above&view=/);
    const other = await openElsewhere(page, WINDOW);
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

  it('have annotations, placed by a click and behind splats or not, which links show', async () => {
    const page = await harness.shareViewer(CHEAP, LARGE);
    await page.keyboard.press('h');
    await page.keyboard.press('p');
    await page.getByTestId('placing').waitFor();
    await page.mouse.click(267, 290);
    await page.getByTestId('annotation-title').waitFor();
    await page.keyboard.type('The vase');
    await page.keyboard.press('Tab');
    await page.keyboard.type('Old: 1900.');
    await page.evaluate(AXE);
    await expectAccessible(page, 'an annotation is edited');
    // Escape closes the card, and keeps what was typed.
    await page.keyboard.press('Escape');
    await page.getByTestId('annotation').waitFor({ state: 'detached' });
    await page.waitForURL(/[?&]annotation=[^&]*,words:The\+vase%0AOld:\+1900\./);
    await page.getByTestId('annotation-1').click();
    await page.waitForURL(/[?&]annotation=[^&]*,words:The\+vase%0AOld:\+1900\./);
    await page.getByTestId('remove-annotation').click();
    await page.getByTestId('annotation-1').waitFor({ state: 'detached' });
    await page.keyboard.press('Control+z');
    const marker = page.getByTestId('annotation-1');
    await marker.waitFor();
    const box = (await marker.boundingBox())!;
    // Its corner is in the middle of the pixel of the layer, which is 4 px wide.
    expect(Math.hypot(box.x + 9 - 267, box.y + 35 - 290)).toBeLessThan(3);
    expect(await marker.getAttribute('data-behind')).toBeNull();
    // From the other side, the vase lies before it.
    await redraw(page, async () => {
      for (let i = 0; i < HALF_TURN_KEYS; i++) await page.keyboard.press('ArrowLeft');
    });
    await page.locator('[data-testid=annotation-1][data-behind]').waitFor();
    await redraw(page, () => page.keyboard.press('v'));
    // Which was undone is told for some seconds.
    await page.getByTestId('notice').waitFor({ state: 'detached' });
    await expectAccessible(page, 'lists of views and annotations');
    await redraw(page, () => page.keyboard.press('v'));
    await page.waitForURL(/[?&]camera=/);

    const alone = await openElsewhere(page, LARGE, '&noui');
    await alone.locator('[data-testid=annotation-1][data-behind]').waitFor();
    // The only annotation is open where the reader is.
    await alone.getByTestId('annotation').waitFor();
    for (const key of ['Tab', 'Tab', 'Enter']) await alone.keyboard.press(key);
    await alone.getByTestId('annotation').waitFor({ state: 'detached' });
    // Opened anew, it takes the camera to where it was placed, by the keyboard too.
    await redraw(alone, () => alone.keyboard.press('Enter'));
    await alone.locator('[data-testid=annotation-1]:not([data-behind])').waitFor();
    expect(await textOf(alone, 'annotation')).toContain('Old: 1900.');
    expect(await alone.getByTestId('edit-annotation').count()).toBe(0);
  });

  it('have markers that stay with the picture on the screen while slow frames are drawn', async () => {
    const page = await harness.newPage({ viewport: { width: 900, height: 600 } });
    await page.addInitScript(notePlaces);
    await page.goto(`${harness.server.url}?scene=still-life-small&accuracy=reference,rasterizer:tiles`);
    await waitForImage(page);
    await page.keyboard.press('p');
    await page.getByTestId('placing').waitFor();
    await page.mouse.click(450, 330);
    await page.getByTestId('annotation-title').waitFor();
    await page.keyboard.press('Escape');
    await page.getByTestId('annotation-1').waitFor();
    await redraw(page, async () => {
      for (let i = 0; i < 4; i++) await page.keyboard.press('ArrowLeft');
    });
    const byPicture = await page.evaluate(() => (window as unknown as { places: string[][] }).places);
    const seen = Object.values(byPicture).filter((places) => places.length > 0);
    expect(seen.length, 'pictures with a marker').toBeGreaterThan(1);
    for (const places of seen) expect(places, 'places of the marker in one picture').toHaveLength(1);
    expect(new Set(seen.flat()).size, 'places of the marker').toBeGreaterThan(1);
  });

  it('are undone by one key with everything else, whatever panel is open', async () => {
    const page = await harness.shareViewer(CHEAP, LARGE);
    await redraw(page, () => page.keyboard.press('v'));
    await page.getByTestId('save-view').click();
    await page.getByTestId('saved-view-1').waitFor();
    await redraw(page, () => page.getByTestId('background-black').click());
    await page.getByRole('button', { name: 'Remove View 1' }).click();
    await page.getByTestId('saved-view-1').waitFor({ state: 'detached' });
    const undo = async (name: string) => {
      await page.keyboard.press('Control+z');
      await waitForNotice(page, `Undone: ${name}.`);
    };
    await page.keyboard.press('x');
    await undo('removal of a view');
    await redraw(page, () => undo('background'));
    await page.keyboard.press('Escape');
    await page.keyboard.press('v');
    await page.getByTestId('saved-view-1').waitFor();
    expect(await page.getByTestId('background-theme').getAttribute('aria-pressed')).toBe('true');
    // The palette names what comes next.
    await page.keyboard.press('?');
    expect(await textOf(page, 'run-undo')).toContain('Undo saved view');
    expect(await textOf(page, 'run-redo')).toContain('Redo background');
    await page.getByTestId('run-undo').click();
    await page.getByTestId('saved-view-1').waitFor({ state: 'detached' });
  });

  it('belong to what a file holds, not to its name, and edits come back', async () => {
    const page = await harness.shareViewer(CHEAP, LARGE);
    const trained = (count: number) => ({ name: 'point_cloud.ply', bytes: encodePly(testScene(count)) });
    const drop = (count: number) => redraw(page, () => dropFiles(page, [trained(count)]));
    await drop(400);
    await waitForScene(page, 'point_cloud.ply');
    await redraw(page, () => page.keyboard.press('v'));
    await page.getByTestId('save-view').click();
    const saved = page.getByTestId('saved-view-1');
    await saved.waitFor();
    await page.keyboard.press('7');
    await redraw(page, () => page.getByTestId('crop-begin').click());
    const figures = page.getByTestId('scene');
    await figures.getByText('cropped').waitFor();
    await page.keyboard.press('v');
    await saved.waitFor();
    // Another one of the same name.
    await drop(300);
    await figures.getByText('300 splats').waitFor();
    await saved.waitFor({ state: 'detached' });
    expect(await figures.getByText('cropped').count()).toBe(0);
    await waitForNotice(page, 'point_cloud.ply had a crop.');
    await page.getByTestId('offer-bring-back').click();
    await figures.getByText('cropped').waitFor();
    await figures.getByText('400 splats').waitFor();
    await saved.waitFor();
  });
});
