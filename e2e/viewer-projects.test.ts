// Proves: what is made of a scene is not lost: projects, reloads, the same files another day.
import { readFile } from 'node:fs/promises';
import { encodePly } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { differing } from './screenshot.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  dropFiles,
  redraw,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForImage,
  waitForNotice,
  waitForScene,
} from './viewer-page.ts';

const harness = viewerHarness();
const LARGE = { viewport: { width: 700, height: 500 } };
const FILE = { name: 'point_cloud.ply', bytes: encodePly(testScene(400)) };
const caption = (page: Page) => page.getByTestId('scene');

/** Removes the splats in the left half of the picture. */
async function removeSome(page: Page): Promise<void> {
  await redraw(page, () => page.keyboard.press('1'));
  // The picture has made room before the panel's code is there.
  await page.getByTestId('select-count').waitFor();
  await page.mouse.move(10, 70);
  await page.mouse.down();
  await page.mouse.move(150, 380, { steps: 3 });
  await redraw(page, () => page.mouse.up());
  await redraw(page, () => page.keyboard.press('Delete'));
  await page.getByTestId('select-count').getByText('removed').waitFor();
  await redraw(page, () => page.keyboard.press('Escape'));
}

async function savedProject(page: Page): Promise<{ name: string; bytes: Uint8Array }> {
  const downloading = page.waitForEvent('download');
  await page.keyboard.press('Control+s');
  const download = await downloading;
  return { name: download.suggestedFilename(), bytes: await readFile(await download.path()) };
}

describe('work on a scene', () => {
  it('is saved as a project, and opened again with its files', async () => {
    const page = await harness.shareViewer(CHEAP, LARGE);
    await page.keyboard.press('h');
    await redraw(page, () => dropFiles(page, [FILE]));
    await waitForScene(page, FILE.name);
    await removeSome(page);
    await redraw(page, () => page.keyboard.press('v'));
    await redraw(page, () => page.getByTestId('background-black').click());
    await page.getByTestId('save-view').click();
    await page.getByTestId('saved-view-name-1').fill('The left is gone');
    await redraw(page, () => page.keyboard.press('Escape'));
    await redraw(page, () => page.keyboard.press('ArrowLeft'));
    const figures = await caption(page).getByText('of 400 splats').textContent();
    const before = await viewerScreenshot(page);
    const project = await savedProject(page);
    expect(project.name).toBe('point_cloud.wsplat');

    // In a browser that has kept nothing, into which the page cannot write while it is left either.
    await page.goto('about:blank');
    const other = await harness.shareViewer(CHEAP, LARGE);
    await other.keyboard.press('h');
    await dropFiles(other, [project]);
    await waitForScene(other, FILE.name);
    await caption(other).getByText('of 400 splats').waitFor();
    expect(await caption(other).getByText('of 400 splats').textContent()).toBe(figures);
    await expect.poll(async () => differing(await viewerScreenshot(other), before)).toBe(0);
    await redraw(other, () => other.keyboard.press('v'));
    await expect.poll(() => other.getByTestId('saved-view-name-1').inputValue()).toBe('The left is gone');
    // It begins as it was saved: there is nothing to undo.
    await other.keyboard.press('?');
    expect(await other.getByTestId('run-undo').isDisabled()).toBe(true);
  });

  it('is told to be no project where it is none, and the scene stays', async () => {
    const page = await harness.shareViewer(CHEAP, LARGE);
    await dropFiles(page, [{ name: 'a.wsplat', bytes: Uint8Array.of(1, 2, 3) }]);
    const failure = page.getByTestId('error');
    await failure.getByText('a.wsplat cannot be opened').waitFor();
    expect(await failure.textContent()).toContain('must be that of a zip archive');
    await waitForScene(page, 'Still life, small', 'error');
  });

  it('is there after a reload, as one step that can be undone', async () => {
    const page = await harness.shareViewer(CHEAP, LARGE);
    await page.keyboard.press('h');
    const whole = await viewerScreenshot(page);
    await removeSome(page);
    const edited = await viewerScreenshot(page);
    expect(differing(edited, whole)).toBeGreaterThan(1000);
    await expect.poll(() => keptEdits(page)).toContain('removed splats');
    await page.reload();
    await waitForImage(page);
    await waitForNotice(page, 'is as you left it, with');
    await expect.poll(async () => differing(await viewerScreenshot(page), edited)).toBe(0);
    await redraw(page, () => page.keyboard.press('Control+z'));
    await expect.poll(async () => differing(await viewerScreenshot(page), whole)).toBe(0);
  });

  it('is offered when the same file is opened another day', async () => {
    const page = await harness.shareViewer(CHEAP, LARGE);
    await page.keyboard.press('h');
    await redraw(page, () => dropFiles(page, [FILE]));
    await waitForScene(page, FILE.name);
    await removeSome(page);
    await expect.poll(() => keptEdits(page)).toContain('removed splats');
    const figures = await caption(page).getByText('of 400 splats').textContent();
    // Another day begins with another tab.
    const address = page.url();
    await page.goto('about:blank');
    const later = await harness.newTab(page);
    await later.goto(address);
    await waitForImage(later);
    await redraw(later, () => dropFiles(later, [{ ...FILE, name: 'renamed.ply' }]));
    await later.getByTestId('kept-edits').getByText('renamed.ply was edited before').waitFor();
    expect(await caption(later).getByText('of 400 splats').count()).toBe(0);
    await later.getByTestId('kept-version').getByRole('button').click();
    await caption(later).getByText('of 400 splats').waitFor();
    expect(await textOf(later, 'scene')).toContain(figures);
  });
});

/** What the browser has kept of edits, of whatever scene. */
function keptEdits(page: Page): Promise<string> {
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
    return asking.result.map(({ edits }) => edits).join();
  });
}
