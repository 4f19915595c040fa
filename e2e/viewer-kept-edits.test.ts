// Proves: edits outlive visits that do not bring them back, other tabs on the same file, and full storage.
import { readFile } from 'node:fs/promises';
import { encodePly } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { AXE, expectAccessible } from './accessible.ts';
import { testScene } from './test-scene.ts';
import { CHEAPLY, redraw, viewerHarness, waitForImage, waitForNotice } from './viewer-page.ts';

const harness = viewerHarness({ 'scene.ply': encodePly(testScene()) });
const ADDRESS = `?src=scene.ply&${CHEAPLY}`;
const LARGE = { viewport: { width: 700, height: 500 } };

/** Splats that are left, as the caption counts them: “312 of 400 splats”. */
const left = (page: Page) => page.getByTestId('scene').getByText('of 400 splats');

/** Opens the scene in another tab of the same browser. */
async function openTab(beside: Page): Promise<Page> {
  const page = await harness.newTab(beside);
  await page.goto(`${harness.server.url}${ADDRESS}`);
  await waitForImage(page);
  await page.keyboard.press('h');
  return page;
}

/** Removes the splats in the picture's left part, and returns what the caption says then. */
async function removeUpTo(page: Page, xPx: number): Promise<string> {
  await redraw(page, () => page.keyboard.press('1'));
  // The picture has made room before the panel's code is there.
  await page.getByTestId('select-count').waitFor();
  await page.mouse.move(10, 70);
  await page.mouse.down();
  await page.mouse.move(xPx, 380, { steps: 3 });
  await redraw(page, () => page.mouse.up());
  await redraw(page, () => page.keyboard.press('Delete'));
  await page.getByTestId('select-count').getByText('removed').waitFor();
  await redraw(page, () => page.keyboard.press('Escape'));
  await left(page).waitFor();
  return left(page).innerText();
}

/** “88 removed splats” of “312 of 400 splats”. */
const removedOf = (figures: string) => `${400 - Number.parseInt(figures, 10)} removed splats`;

/** Edits that the browser keeps, of whatever scene. */
function keptEdits(page: Page): Promise<string[]> {
  return page.evaluate(async () => {
    const opening = indexedDB.open('websplatter edits', 1);
    opening.onupgradeneeded = () => opening.result.createObjectStore('scenes');
    await new Promise((resolve) => {
      opening.onsuccess = resolve;
    });
    const asking = opening.result.transaction('scenes').objectStore('scenes').getAll();
    await new Promise((resolve) => {
      asking.onsuccess = resolve;
    });
    opening.result.close();
    return asking.result.map(({ edits }) => edits);
  });
}

/** Waits until the browser keeps the edits, and closes the tab. */
async function closeOnceKept(page: Page, edits: string): Promise<void> {
  await expect.poll(() => keptEdits(page)).toContain(edits);
  await page.close();
}

async function reload(page: Page): Promise<void> {
  await page.reload();
  await waitForImage(page);
}

describe('edits of a scene', () => {
  /**
   * @fault Order: a scene is opened again, its kept edits are not brought back, and it is edited anew
   * @consequence Both versions are kept and offered with their times. Either can be chosen.
   */
  it('outlive a visit that makes others', async () => {
    const first = await harness.openViewer(ADDRESS, LARGE);
    await first.keyboard.press('h');
    // Keeps the browser while no tab has the scene.
    const others = await harness.newTab(first);
    const older = await removeUpTo(first, 220);
    await closeOnceKept(first, removedOf(older));

    const second = await openTab(others);
    expect(await left(second).count()).toBe(0);
    const newer = await removeUpTo(second, 90);
    expect(newer).not.toBe(older);
    await closeOnceKept(second, removedOf(newer));

    const third = await openTab(others);
    expect(new Set(await keptEdits(third))).toEqual(new Set([removedOf(older), removedOf(newer)]));
    const versions = third.getByTestId('kept-version');
    await expect.poll(() => versions.allInnerTexts()).toHaveLength(2);
    const [newerText, olderText] = await versions.allInnerTexts();
    expect(newerText).toMatch(new RegExp(`${removedOf(newer)}[^]*\\d\\d:\\d\\d`));
    expect(olderText).toMatch(new RegExp(`${removedOf(older)}[^]*\\d\\d:\\d\\d`));
    await redraw(third, () => versions.nth(1).getByRole('button').click());
    expect(await left(third).innerText()).toBe(older);
    // It is only looked at: undone, it is offered again.
    await redraw(third, () => third.keyboard.press('Control+z'));
    await expect.poll(() => versions.allInnerTexts()).toHaveLength(2);
    await redraw(third, () => versions.nth(0).getByRole('button').click());
    expect(await left(third).innerText()).toBe(newer);
    expect(await versions.allInnerTexts()).toEqual([expect.stringContaining(removedOf(older))]);
  });

  /**
   * @fault Order: two tabs edit the same file, are loaded again, or one is a copy of the other
   * @consequence Each tab comes back with its own edits, and is told of the other one.
   */
  it('are each tab’s own, and a second tab is told', async () => {
    const a = await harness.openViewer(ADDRESS, LARGE);
    await a.keyboard.press('h');
    const ofA = await removeUpTo(a, 90);
    await expect.poll(() => keptEdits(a)).toContain(removedOf(ofA));
    const b = await openTab(a);
    const ofB = await removeUpTo(b, 220);
    await expect.poll(() => keptEdits(b)).toContain(removedOf(ofB));
    await reload(a);
    await waitForNotice(a, `is as you left it, with ${removedOf(ofA)}`);
    expect(await left(a).innerText()).toBe(ofA);
    await b.getByTestId('kept-edits').getByText('also edited in another tab').waitFor();
    await reload(b);
    await waitForNotice(b, `is as you left it, with ${removedOf(ofB)}`);
    expect(await left(b).innerText()).toBe(ofB);

    // A copied tab has its session's storage, too.
    const opening = a.context().waitForEvent('page');
    await a.evaluate(() => void open(location.href));
    const copy = await opening;
    await waitForImage(copy);
    await copy.getByTestId('kept-edits').getByText('also edited in another tab').waitFor();
    const ofCopy = await removeUpTo(copy, 300);
    await expect.poll(() => keptEdits(copy)).toContain(removedOf(ofCopy));
    await reload(a);
    await waitForNotice(a, `is as you left it, with ${removedOf(ofA)}`);
    await reload(copy);
    await left(copy).getByText(ofCopy).waitFor();
  });

  /**
   * @fault Saved files: the browser's storage is full
   * @consequence A notice says so at the first edit, until there is room again; it offers to save a project.
   */
  it('are said to be lost if there is no room, until there is', async () => {
    const page = await harness.openViewer(ADDRESS, LARGE);
    await page.keyboard.press('h');
    const session = await page.context().newCDPSession(page);
    const origin = new URL(harness.server.url).origin;
    await session.send('Storage.overrideQuotaForOrigin', { origin, quotaSize: 1 });
    await removeUpTo(page, 90);
    const panel = page.getByTestId('unkept');
    await panel.getByText('no room to keep your work').waitFor();
    await page.evaluate(AXE);
    await expectAccessible(page, 'full storage');
    const downloading = page.waitForEvent('download');
    await panel.getByRole('button', { name: 'Save project' }).click();
    const download = await downloading;
    expect(download.suggestedFilename()).toBe('scene.wsplat');
    expect((await readFile(await download.path())).length).toBeGreaterThan(100);
    await session.send('Storage.overrideQuotaForOrigin', { origin });
    await removeUpTo(page, 220);
    await panel.waitFor({ state: 'detached' });
  });
});
