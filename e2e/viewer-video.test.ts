// Proves: a video of the path through saved views: frames, cancelling, no encoder; settings for SuperSplat.
import { readFile } from 'node:fs/promises';
import { encodePly } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { expect, it } from 'vitest';
import { playbackOf, playVideo } from './play-video.ts';
import { psnrOf } from './screenshot.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAPLY,
  drawnCamera,
  dropFiles,
  openSaveTab,
  redraw,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForNotice,
} from './viewer-page.ts';

const { newPage, openViewer } = viewerHarness({ 'scene.ply': encodePly(testScene()) });
/** SwiftShader draws it in less time than the built-in scenes. */
const ADDRESS = `?src=scene.ply&${CHEAPLY}`;

/** Buttons of panels can be clicked in it. */
const WINDOW = { viewport: { width: 480, height: 320 } };
/** Two views are 2.5 s apart: 30 frames a second, and the last view. */
const FRAMES = 76;

/** Saves two views of the scene; returns their pictures without a panel. */
async function saveTwoViews(page: Page) {
  // The figures cover much of so small an image.
  await page.keyboard.press('h');
  const saveView = async (name: string) => {
    const picture = await viewerScreenshot(page);
    await redraw(page, () => page.keyboard.press('v'));
    await page.getByTestId('save-view').click();
    await page.getByTestId(name).waitFor();
    await redraw(page, () => page.keyboard.press('v'));
    return picture;
  };
  const first = await saveView('saved-view-1');
  await redraw(page, async () => {
    await page.mouse.move(240, 120);
    await page.mouse.down();
    await page.mouse.move(120, 150);
    await page.mouse.up();
  });
  return { first, last: await saveView('saved-view-2') };
}

/** Plays a video in `page`: its length, and its first and last frames. */
const play = async (page: Page, video: Buffer) =>
  playbackOf(await page.evaluate(playVideo, video.toString('base64')));

it('saves the path through saved views as a video that shows them as their pictures do', async () => {
  const page = await openViewer(ADDRESS, WINDOW);
  await openSaveTab(page, 'picture');
  expect(await textOf(page, 'video-about')).toContain('save two or more');
  expect(await page.getByTestId('save-video').isDisabled()).toBe(true);
  await page.keyboard.press('x');
  const pictures = await saveTwoViews(page);
  await redraw(page, () => openSaveTab(page, 'picture'));
  expect(await textOf(page, 'video-about')).toContain(`2 views, 2.5 s, ${FRAMES} frames of 480 × 320 px`);

  await page.getByTestId('save-video').click();
  await page.getByTestId('cancel-video').click();
  await waitForNotice(page, 'cancelled');

  const downloading = page.waitForEvent('download');
  await page.getByTestId('save-video').click();
  const download = await downloading;
  expect(download.suggestedFilename()).toBe('scene.webm');
  await waitForNotice(page, 'Saved scene.webm');
  const { durationS, first, last } = await play(await newPage(), await readFile(await download.path()));
  expect(durationS).toBeCloseTo(FRAMES / 30, 2);
  expect(psnrOf(first, pictures.first)).toBeGreaterThan(25);
  expect(psnrOf(last, pictures.last)).toBeGreaterThan(25);
  // The frames are told apart.
  expect(psnrOf(first, pictures.last)).toBeLessThan(25);
});

it('says so where the browser cannot encode, and where it stops to', async () => {
  const page = await openViewer(ADDRESS, WINDOW);
  await saveTwoViews(page);
  await page.evaluate(() => {
    const { VideoEncoder: Real } = window;
    Object.assign(window, { Real });
    Reflect.deleteProperty(window, 'VideoEncoder');
  });
  await redraw(page, () => openSaveTab(page, 'picture'));
  await expect.poll(() => textOf(page, 'video-about')).toContain('it has no VideoEncoder');
  expect(await page.getByTestId('save-video').isDisabled()).toBe(true);

  await page.keyboard.press('x');
  await page.evaluate(() => {
    const { Real } = window as unknown as { Real: typeof VideoEncoder };
    class Failing extends Real {
      constructor(init: VideoEncoderInit) {
        super(init);
        queueMicrotask(() => init.error(new DOMException('out of order', 'EncodingError')));
      }
    }
    Object.assign(window, { VideoEncoder: Failing });
  });
  await openSaveTab(page, 'picture');
  await page.getByTestId('save-video').click();
  await page.getByText('VP9 encoder stopped at 480 × 320 px: out of order').waitFor();
  expect(await page.getByTestId('filming').count()).toBe(0);
});

it('saves settings that show the scene as it was when they are dropped on it', async () => {
  const page = await openViewer(ADDRESS, WINDOW);
  await redraw(page, () => page.keyboard.press('+'));
  await redraw(page, () => page.keyboard.press('v'));
  await redraw(page, () => page.getByTestId('background-white').click());
  await redraw(page, () => page.keyboard.press('v'));
  const before = await drawnCamera(page);
  await redraw(page, () => openSaveTab(page, 'file'));
  const downloading = page.waitForEvent('download');
  await page.getByTestId('save-settings').click();
  const download = await downloading;
  expect(download.suggestedFilename()).toBe('settings.json');
  const bytes = await readFile(await download.path());

  await redraw(page, () => page.keyboard.press('x'));
  await redraw(page, () => page.keyboard.press('+'));
  expect((await drawnCamera(page)).viewMatrix).not.toEqual(before.viewMatrix);
  await redraw(page, () => dropFiles(page, [{ name: 'settings.json', bytes }]));
  const after = await drawnCamera(page);
  expect(after.background).toEqual(before.background);
  for (const matrix of ['viewMatrix', 'projectionMatrix'] as const)
    for (const [i, value] of before[matrix].entries()) expect(after[matrix][i]).toBeCloseTo(value, 9);
});
