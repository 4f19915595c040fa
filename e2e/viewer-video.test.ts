// Proves: videos of the camera path as MP4 and WebM: frames, cancelling, no encoder; settings for SuperSplat.
import { readFile } from 'node:fs/promises';
import { encodePly } from '@websplatter/core';
import { ALL_FORMATS, BufferSource, Input } from 'mediabunny';
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
  press,
  redraw,
  SMALL,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForNotice,
} from './viewer-page.ts';

const { newPage, shareViewer } = viewerHarness({ 'scene.ply': encodePly(testScene()) });
/** SwiftShader draws it in less time than the built-in scenes. */
const ADDRESS = `?src=scene.ply&${CHEAPLY}`;

/** Two views are 2.5 s apart: 30 frames a second, and the last view. */
const FRAMES = 76;
/** Each turns by 5 degrees. */
const TURN_KEYS = 8;

/** Saves two views of the scene; returns their pictures without a panel. */
async function saveTwoViews(page: Page) {
  // The figures cover much of so small an image.
  await page.keyboard.press('h');
  const saveView = async (name: string) => {
    const picture = await viewerScreenshot(page);
    await redraw(page, () => page.keyboard.press('v'));
    await press(page, 'save-view');
    await page.getByTestId(name).waitFor({ state: 'attached' });
    await redraw(page, () => page.keyboard.press('v'));
    return picture;
  };
  const first = await saveView('saved-view-1');
  await redraw(page, async () => {
    for (let i = 0; i < TURN_KEYS; i++) await page.keyboard.press('ArrowLeft');
  });
  return { first, last: await saveView('saved-view-2') };
}

/** Plays a video in `page`: its length, and its first and last frames. */
const play = async (page: Page, video: Buffer, type: string) =>
  playbackOf(await page.evaluate(playVideo, { base64: video.toString('base64'), type }));

/** What a video's file says of itself, and how many frames are in it. */
async function contentsOf(video: Buffer) {
  const input = new Input({ source: new BufferSource(video), formats: ALL_FORMATS });
  const [track] = await input.getVideoTracks();
  const { packetCount } = await track.computePacketStats();
  return {
    format: (await input.getFormat()).name,
    durationS: await track.computeDuration(),
    frames: packetCount,
    size: [track.displayWidth, track.displayHeight],
  };
}

/** Saves the video that the panel offers. */
async function saveVideo(page: Page, fileName: string): Promise<Buffer> {
  const downloading = page.waitForEvent('download');
  await press(page, 'save-video');
  const download = await downloading;
  expect(download.suggestedFilename()).toBe(fileName);
  await waitForNotice(page, `Saved ${fileName}`);
  return readFile(await download.path());
}

/** Begins to save a video. The page cancels that once it tells how long it takes: a test could be too late. */
async function cancelVideo(page: Page): Promise<void> {
  await page.locator('[data-testid=save-video]:not(:disabled)').waitFor({ state: 'attached' });
  await page.waitForFunction(
    () =>
      new Promise<boolean>((resolve) => {
        const observer = new MutationObserver(() => {
          const told = document.querySelector('[data-testid=filming-label]')?.textContent ?? '';
          if (!/^Frame \d+ of 76 · .* left$/.test(told)) return;
          observer.disconnect();
          document.querySelector<HTMLElement>('[data-testid=cancel-video]')!.click();
          resolve(true);
        });
        observer.observe(document, { childList: true, characterData: true, attributes: true, subtree: true });
        document.querySelector<HTMLElement>('[data-testid=save-video]')!.click();
      }),
  );
}

it('saves the path through saved views as a video that shows them as their pictures do', async () => {
  const page = await shareViewer(ADDRESS, SMALL);
  await openSaveTab(page, 'picture');
  expect(await textOf(page, 'video-about')).toContain('save two or more');
  expect(await page.getByTestId('save-video').count()).toBe(0);
  await page.keyboard.press('x');
  const pictures = await saveTwoViews(page);
  await redraw(page, () => openSaveTab(page, 'picture'));
  expect(await textOf(page, 'video-about')).toContain(`2 views, 2.5 s, ${FRAMES} frames of 240 × 160 px`);

  await cancelVideo(page);
  await waitForNotice(page, 'cancelled');

  await press(page, 'video-webm');
  const video = await saveVideo(page, 'scene.webm');
  expect(await contentsOf(video)).toMatchObject({ format: 'WebM', frames: FRAMES, size: [240, 160] });
  const { durationS, first, last } = await play(await newPage(), video, 'video/webm');
  expect(durationS).toBeCloseTo(FRAMES / 30, 2);
  expect(psnrOf(first, pictures.first)).toBeGreaterThan(25);
  expect(psnrOf(last, pictures.last)).toBeGreaterThan(25);
  // The frames are told apart.
  expect(psnrOf(first, pictures.last)).toBeLessThan(25);
});

it('saves a turntable as MP4 without a saved view: no frame of its loop is there twice', async () => {
  const page = await shareViewer(ADDRESS, SMALL);
  await page.keyboard.press('h');
  const picture = await viewerScreenshot(page);
  await redraw(page, () => openSaveTab(page, 'picture'));
  await press(page, 'video-turntable');
  expect(await textOf(page, 'video-about')).toContain('Turntable, 10 s, 300 frames of 240 × 160 px');
  await press(page, 'video-path');
  await page.getByTestId('turntable-seconds').fill('1');
  await redraw(page, () => page.keyboard.press('Escape'));
  await redraw(page, () => openSaveTab(page, 'picture'));
  expect(await textOf(page, 'video-about')).toContain('Turntable, 1 s, 30 frames of 240 × 160 px');
  const preview = page.getByTestId('preview-path');
  await press(page, 'preview-path');
  await preview.getByText('Pause').waitFor();
  // It goes around again and again.
  await press(page, 'preview-path');
  await preview.getByText('Preview').waitFor();
  const video = await saveVideo(page, 'scene.mp4');
  const contents = await contentsOf(video);
  expect(contents).toMatchObject({ format: 'MP4', frames: 30, size: [240, 160] });
  expect(contents.durationS).toBeCloseTo(1, 3);
  const { durationS, first, last } = await play(await newPage(), video, 'video/mp4');
  expect(durationS).toBeCloseTo(1, 2);
  expect(psnrOf(first, picture)).toBeGreaterThan(25);
  // A thirtieth of a turn before its beginning.
  expect(psnrOf(last, picture)).toBeLessThan(psnrOf(first, picture));
});

it('offers what the browser encodes, and says why it does not offer the rest', async () => {
  const page = await shareViewer(ADDRESS, SMALL);
  await page.evaluate(() => {
    const isConfigSupported = VideoEncoder.isConfigSupported.bind(VideoEncoder);
    VideoEncoder.isConfigSupported = async (config) =>
      config.codec.startsWith('avc1') || config.codec.startsWith('av01') || config.width > 2000
        ? { supported: false, config }
        : config.codec.startsWith('vp09') && config.framerate === 60
          ? { supported: false, config }
          : isConfigSupported(config);
  });
  await redraw(page, () => openSaveTab(page, 'picture'));
  await press(page, 'video-turntable');
  await expect.poll(() => page.getByTestId('video-4k').isDisabled()).toBe(true);
  expect(await page.getByTestId('video-4k').getAttribute('title')).toContain('cannot encode this size');
  expect(await page.getByTestId('video-mp4').isEnabled()).toBe(true);
  await press(page, 'video-rate-60');
  expect(await page.getByTestId('video-mp4').isDisabled()).toBe(true);
  expect(await textOf(page, 'video-missing')).toBe(
    'This browser encodes no H.264, AV1, and VP9 for MP4 at this size and rate.',
  );
  expect(await textOf(page, 'save-video')).toBe('Save .webm');
});

it('says so where the browser cannot encode, and where it stops to', async () => {
  const page = await shareViewer(ADDRESS, SMALL);
  await saveTwoViews(page);
  await page.evaluate(() => {
    const { VideoEncoder: Real } = window;
    Object.assign(window, { Real });
    Reflect.deleteProperty(window, 'VideoEncoder');
  });
  await redraw(page, () => openSaveTab(page, 'picture'));
  await expect.poll(() => textOf(page, 'video-about')).toContain('it has no VideoEncoder');
  expect(await page.getByTestId('save-video').count()).toBe(0);

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
  await press(page, 'video-webm');
  await press(page, 'save-video');
  await page.getByText('VP9 encoder stopped at 240 × 160 px: out of order').waitFor();
  expect(await page.getByTestId('filming').count()).toBe(0);
});

it('saves settings that show the scene as it was when they are dropped on it', async () => {
  const page = await shareViewer(ADDRESS, SMALL);
  await redraw(page, () => page.keyboard.press('+'));
  await redraw(page, () => page.keyboard.press('v'));
  await redraw(page, () => press(page, 'background-white'));
  await redraw(page, () => page.keyboard.press('v'));
  const before = await drawnCamera(page);
  await redraw(page, () => openSaveTab(page, 'file'));
  const downloading = page.waitForEvent('download');
  await press(page, 'save-settings');
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
