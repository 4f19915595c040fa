// Proves: the camera path's strip by pointer and keys, its undo, links, and files of other programs.
import { readFile } from 'node:fs/promises';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { AXE, expectAccessible } from './accessible.ts';
import {
  CHEAP,
  type DrawnCamera,
  drawnCamera,
  press,
  redraw,
  textOf,
  viewerHarness,
  waitForNotice,
} from './viewer-page.ts';

const harness = viewerHarness();
const WINDOW = { viewport: { width: 900, height: 600 } };

/** Opens the strip. */
async function openStrip(page: Page): Promise<void> {
  await redraw(page, () => page.keyboard.press('q'));
  await page.getByTestId('path-strip').waitFor();
}

/** Adds views, and turns the picture by 5° after each. */
async function addViews(page: Page, count: number): Promise<void> {
  for (let i = 1; i <= count; i++) {
    await page.getByTestId('add-view').click();
    await page.getByTestId(`path-key-${i}`).waitFor();
    await page.getByTestId('viewport').focus();
    await redraw(page, () => page.keyboard.press('ArrowLeft'));
  }
}

/** Sets how long the path takes from its first view to the next. */
async function setSeconds(page: Page, seconds: string): Promise<void> {
  await redraw(page, () => page.getByTestId('path-key-1').click());
  await page.getByTestId('path-key-seconds').fill(seconds);
}

const nameOf = (page: Page, key: number) => page.getByTestId(`path-key-${key}`).getAttribute('aria-label');
const namesOf = (page: Page) =>
  page
    .getByTestId('path-keys')
    .getByRole('button')
    .evaluateAll((keys) => keys.map((key) => key.getAttribute('aria-label')));
const viewsIn = (page: Page) => new URL(page.url()).searchParams.getAll('view');

function expectSameView(actual: DrawnCamera, expected: DrawnCamera): void {
  for (const [i, value] of expected.viewMatrix.entries())
    expect(Math.abs(actual.viewMatrix[i] - value), `[${i}]`).toBeLessThan(1e-5);
}

describe('the camera path', () => {
  it('leads through views that are named, timed, moved, replaced and removed, and undone by one key', async () => {
    const page = await harness.shareViewer(CHEAP, WINDOW);
    await openStrip(page);
    expect(await page.getByTestId('play-path').isDisabled()).toBe(true);
    expect(await textOf(page, 'path-empty')).toContain('two views or more');
    await addViews(page, 3);
    for (const [i, name] of ['A', 'B', 'C'].entries()) {
      await redraw(page, () => page.getByTestId(`path-key-${i + 1}`).click());
      await page.getByTestId('path-key-name').fill(name);
    }
    expect(await namesOf(page)).toEqual(['A, at 0.0 seconds', 'B, at 2.5 seconds', 'C, at 5.0 seconds']);

    // By pointer: C goes before B, a quarter of the way from A.
    const [first, third] = await Promise.all(
      [1, 3].map(async (key) => (await page.getByTestId(`path-key-${key}`).boundingBox())!),
    );
    const y = first.y + first.height / 2;
    const x = third.x + third.width / 2;
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x - 0.75 * (third.x - first.x), y, { steps: 4 });
    await page.mouse.up();
    await expect
      .poll(() => namesOf(page))
      .toEqual(['A, at 0.0 seconds', expect.stringMatching(/^C, at 1\.[23] seconds$/), 'B, at 2.5 seconds']);
    await page.keyboard.press('Control+z');
    await expect.poll(() => nameOf(page, 3)).toBe('C, at 5.0 seconds');
    await waitForNotice(page, 'Undone: move of a view.');

    // By keys.
    await page.getByTestId('path-key-1').focus();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('Shift+ArrowRight');
    await expect.poll(() => nameOf(page, 3)).toBe('B, at 5.0 seconds');
    await page.keyboard.press('Delete');
    await expect.poll(() => namesOf(page)).toEqual(['A, at 0.0 seconds', 'C, at 2.5 seconds']);

    await redraw(page, () => page.getByTestId('path-key-1').click());
    await page.getByTestId('path-key-seconds').fill('4');
    await page.getByTestId('passing-stop').click();
    await page.getByTestId('loop-path').click();
    expect(await textOf(page, 'path-time')).toBe('0.0 of 6.5 s');
    await page.waitForURL(/view=[^&]*,next:4,pass:stop,name:A&view=[^&]*name:C&path=loop/);

    // Replaced by another view, it keeps its name and its time.
    const before = viewsIn(page)[0];
    await page.getByTestId('viewport').focus();
    await redraw(page, () => page.keyboard.press('ArrowUp'));
    await press(page, 'overwrite-view');
    await expect.poll(() => viewsIn(page)[0]).not.toBe(before);
    expect(viewsIn(page)[0]).toMatch(/,next:4,pass:stop,name:A$/);

    // In a browser that has kept nothing, into which the page cannot write while it is left either.
    const { search } = new URL(page.url());
    await page.goto('about:blank');
    await harness.shareViewer(search, WINDOW);
    await openStrip(page);
    expect(await namesOf(page)).toEqual(['A, at 0.0 seconds', 'C, at 4.0 seconds']);
    expect(await textOf(page, 'path-time')).toBe('0.0 of 6.5 s');
  });

  it('is played and scrubbed, and ends where a person takes hold of the picture', async () => {
    const page = await harness.shareViewer(CHEAP, WINDOW);
    await openStrip(page);
    const first = await drawnCamera(page);
    await addViews(page, 2);
    // Long enough for a busy machine to see it play.
    await setSeconds(page, '30');
    const playhead = page.getByTestId('path-playhead');
    await playhead.focus();
    await redraw(page, () => page.keyboard.press('End'));
    expect(await textOf(page, 'path-time')).toBe('30.0 of 30.0 s');
    await redraw(page, () => page.keyboard.press('Home'));
    expectSameView(await drawnCamera(page), first);
    await redraw(page, () => page.keyboard.press('End'));
    // Its end is reached: it begins anew, and a drag ends it.
    await page.getByTestId('play-path').click();
    await expect.poll(() => textOf(page, 'play-path')).toBe('Pause');
    await page.mouse.move(500, 200);
    await page.mouse.down();
    await page.mouse.move(540, 210, { steps: 3 });
    await page.mouse.up();
    await expect.poll(() => textOf(page, 'play-path')).toBe('Play');
    await setSeconds(page, '1');
    await page.getByTestId('play-path').click();
    await expect.poll(() => textOf(page, 'path-time')).toBe('1.0 of 1.0 s');
    await expect.poll(() => textOf(page, 'play-path')).toBe('Play');
  });

  it('is a turntable without a saved view, which becomes views to be edited', async () => {
    const page = await harness.shareViewer(CHEAP, WINDOW);
    await openStrip(page);
    await page.getByTestId('turntable').click();
    await page.waitForURL(/path=turntable:10,/);
    expect(await namesOf(page)).toEqual(
      [0, 90, 180, 270].map((degrees, i) => `${degrees}°, at ${(2.5 * i).toFixed(1)} seconds`),
    );
    await page.getByTestId('keep-turntable').click();
    await page.waitForURL(/path=loop&view=[^&]*name:Turntable\+0/);
    expect(await textOf(page, 'path-time')).toBe('0.0 of 10.0 s');
    await page.keyboard.press('Control+z');
    await page.waitForURL(/path=turntable:10,/);
    expect(viewsIn(page)).toEqual([]);
  });

  it('goes out as glTF and comes back, and comes from COLMAP by a drop; other files are refused', async () => {
    const page = await harness.shareViewer(CHEAP, WINDOW);
    await openStrip(page);
    const first = await drawnCamera(page);
    await addViews(page, 2);
    const downloading = page.waitForEvent('download');
    await press(page, 'export-path-glb');
    const bytes = await readFile(await (await downloading).path());
    for (const key of [2, 1]) {
      await page.getByTestId(`path-key-${key}`).focus();
      await page.keyboard.press('Delete');
    }
    await page.getByTestId('path-empty').waitFor();
    await page.getByTestId('viewport').focus();
    await redraw(page, () => page.keyboard.press('ArrowUp'));
    const input = page.getByTestId('path-input');
    await input.setInputFiles({ name: 'path.glb', mimeType: 'model/gltf-binary', buffer: bytes });
    await waitForNotice(page, 'path.glb: the path has 26 views of 76 cameras');
    await redraw(page, () => page.getByTestId('path-key-1').click());
    expectSameView(await drawnCamera(page), first);

    const dropped = await page.evaluateHandle(() => {
      const transfer = new DataTransfer();
      transfer.items.add(new File(['1 1 0 0 0 0 0 4 1 a.jpg\n\n2 1 0 0 0 1 0 4 1 b.jpg\n\n'], 'images.txt'));
      return transfer;
    });
    const strip = page.getByTestId('path-strip');
    for (const type of ['dragenter', 'dragover']) await strip.dispatchEvent(type, { dataTransfer: dropped });
    expect(await page.getByTestId('drop-overlay').isVisible()).toBe(false);
    await strip.dispatchEvent('drop', { dataTransfer: dropped });
    await expect.poll(() => namesOf(page)).toEqual(['a, at 0.0 seconds', 'b, at 0.5 seconds']);
    expect(await page.title()).toContain('Still life');
    await page.keyboard.press('Control+z');
    await expect.poll(() => namesOf(page).then((names) => names.length)).toBe(26);

    await input.setInputFiles({ name: 'notes.txt', mimeType: 'text/plain', buffer: Buffer.from('Hello') });
    await page.getByTestId('error').waitFor();
    expect(await textOf(page, 'error-message')).toContain('notes.txt has no camera path that can be read');
    expect((await namesOf(page)).length).toBe(26);
  });

  it('has nothing that axe-core finds wrong, and leaves room for the picture and a panel', async () => {
    const page = await harness.openViewer(CHEAP, { viewport: { width: 360, height: 640 } });
    await page.evaluate(AXE);
    await openStrip(page);
    await expectAccessible(page, 'without a path');
    await addViews(page, 2);
    await redraw(page, () => page.getByTestId('path-key-1').click());
    await expectAccessible(page, 'a selected view');
    const strip = (await page.getByTestId('path-strip').boundingBox())!;
    expect(strip.y).toBeGreaterThan(320);
    expect(strip.x + strip.width).toBeLessThanOrEqual(360);
    // A panel is in its place on a phone, and goes where the strip is asked for.
    await page.keyboard.press('v');
    await page.getByTestId('view').waitFor();
    expect(await page.getByTestId('path-strip').isVisible()).toBe(false);
    await page.keyboard.press('v');
    await page.getByTestId('path-strip').waitFor();
    await page.getByTestId('turntable').click();
    await expectAccessible(page, 'a turntable');
    await page.getByTestId('viewport').focus();
    await page.keyboard.press('Escape');
    expect(await page.getByTestId('path-strip').count()).toBe(0);
  });
});
