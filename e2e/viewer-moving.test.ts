// Proves: a moving scene and a file of frames are shown at a time, played, scrubbed and saved.
import { readFile } from 'node:fs/promises';
import { encodePly, type GeometryPrecision, MOTION_SLOT, MOTION_VALUES, readSplats } from '@websplatter/core';
import { splatsFromArrays } from '@websplatter/core/own-data';
import { openFrameWriter } from '@websplatter/core/write';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { playbackOf, playVideo } from './play-video.ts';
import { changedPart, psnrOf } from './screenshot.ts';
import {
  CHEAP,
  CHEAPLY,
  dropFiles,
  IMAGE_ALONE,
  isAtRestAfter,
  openSaveTab,
  press,
  redraw,
  SMALL,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForScene,
} from './viewer-page.ts';

/** Frames per second of the file of frames, and how many it has. */
const FRAMES_PER_S = 4;
const FRAMES = 8;
const DANCE = await framesFile();

const harness = viewerHarness({ 'dance.frames': DANCE });
const { shareViewer } = harness;

const COUNT = 400;

/** A ring of splats, each there for a while; all turn about the middle. */
function ring() {
  const angles = Array.from({ length: COUNT }, (_, i) => (2 * Math.PI * i) / COUNT);
  const motion = new Float32Array(MOTION_VALUES * COUNT);
  for (const [i, angle] of angles.entries()) {
    const at = MOTION_VALUES * i;
    motion[at + MOTION_SLOT.time] = ((7 * i) % COUNT) / COUNT;
    motion[at + MOTION_SLOT.logDuration] = -2;
    motion.set([-Math.sin(angle), Math.cos(angle), 0], at + MOTION_SLOT.velocity);
  }
  const set = splatsFromArrays({
    positions: angles.flatMap((angle) => [Math.cos(angle), Math.sin(angle), 0]),
    scales: new Float32Array(3 * COUNT).fill(0.05),
    colors: angles.flatMap((angle) => [0.5 + 0.5 * Math.cos(angle), 0.5 + 0.5 * Math.sin(angle), 0.4]),
  });
  return { ...set, motion };
}

const SET = ring();

/** Half a second of a file of frames, half of a scene of moving splats: what each shows after 2.5 s. */
it.each([
  ['dancer.ply', encodePly(SET)],
  ['dance.frames', DANCE],
])('%s goes on in a video, from the time that is shown', async (name, bytes) => {
  const page = await shareViewer(CHEAP, SMALL);
  await dropFiles(page, [{ name, bytes }]);
  await waitForScene(page, name);
  const showTime = async (time: string) => {
    await page.getByTestId('scene-time').fill(time);
    await page.locator('[data-testid=time-bar]:not([data-awaited])').waitFor();
    await page.waitForFunction(isAtRestAfter, 0);
  };
  const picture = () => viewerScreenshot(page, IMAGE_ALONE);
  await showTime('0.5');
  const later = await picture();
  await showTime('0');
  const first = await picture();
  // Twice the same view, so that only the scene moves.
  await redraw(page, () => page.keyboard.press('v'));
  for (const view of ['saved-view-1', 'saved-view-2']) {
    await press(page, 'save-view');
    await page.getByTestId(view).waitFor();
  }
  await redraw(page, () => page.keyboard.press('v'));
  await redraw(page, () => openSaveTab(page, 'picture'));
  await press(page, 'video-webm');
  expect(await textOf(page, 'video-about')).toContain('2 views, 2.5 s');
  const downloading = page.waitForEvent('download');
  await press(page, 'save-video');
  const video = await readFile(await (await downloading).path());
  const base64 = video.toString('base64');
  const played = playbackOf(
    await (await harness.newPage()).evaluate(playVideo, { base64, type: 'video/webm' }),
  );
  expect(psnrOf(played.first, first)).toBeGreaterThan(25);
  expect(psnrOf(played.last, later)).toBeGreaterThan(25);
  // The two times are told apart.
  expect(psnrOf(played.last, first)).toBeLessThan(22);
});

/**
 * @fault Time: figures are open while a moving scene plays
 * @consequence they tell of the frames that are shown, and the chart has all of them
 */
it('moving scenes and files of frames have live figures while they play', async () => {
  const page = await shareViewer(CHEAP, { viewport: { width: 660, height: 490 } });
  for (let size = 0; size < 2; size++) await press(page, 'hud-more');
  for (const { name, bytes } of [
    { name: 'dancer.ply', bytes: encodePly(SET) },
    { name: 'dance.frames', bytes: DANCE },
  ]) {
    await dropFiles(page, [{ name, bytes }]);
    await waitForScene(page, name);
    await page.getByTestId('left-peak').waitFor({ state: 'attached' });
    await press(page, 'play-scene');
    const [totals, times] = [new Set<string>(), new Set<string>()];
    await expect
      .poll(async () => {
        const headline = await textOf(page, 'hud-headline');
        // In motion they tell the pace, and no chart begins anew with a frame.
        if (headline.includes('fps') && /\d/.test(await textOf(page, 'left-peak'))) {
          totals.add(await textOf(page, 'total-ms'));
          times.add(await textOf(page, 'scene-time-text'));
        }
        return Math.min(totals.size, times.size);
      })
      .toBeGreaterThan(3);
  }
});

describe('a moving scene', () => {
  it('has a bar that scrubs and plays it, and is gone with the next scene, which stands still', async () => {
    const page = await shareViewer(CHEAP, { viewport: { width: 480, height: 320 } });
    await dropFiles(page, [{ name: 'dancer.ply', bytes: encodePly(SET) }]);
    await waitForScene(page, 'dancer.ply');
    const time = page.getByTestId('scene-time');
    expect(await textOf(page, 'scene-time-text')).toBe('0.00');
    const picture = () => viewerScreenshot(page, IMAGE_ALONE);
    const first = await picture();
    await redraw(page, () => time.fill('0.5'));
    expect(await textOf(page, 'scene-time-text')).toBe('0.50');
    const half = await picture();
    expect(changedPart(first, half)).toBeGreaterThan(0.02);
    await redraw(page, () => time.press('Home'));
    expect(changedPart(first, await picture())).toBe(0);

    await page.getByTestId('play-scene').click();
    await expect.poll(() => time.inputValue().then(Number)).toBeGreaterThan(0.1);
    await page.getByTestId('play-scene').click();
    await page.waitForFunction(isAtRestAfter, 0);
    const paused = await time.inputValue();
    expect(Number(paused)).toBeGreaterThan(0.1);
    expect(await page.getByTestId('play-scene').getAttribute('aria-label')).toBe('Play the scene');

    const { motion: _, ...still } = SET;
    await dropFiles(page, [{ name: 'still.ply', bytes: encodePly(still) }]);
    await waitForScene(page, 'still.ply');
    expect(await page.getByTestId('time-bar').count()).toBe(0);
    await dropFiles(page, [{ name: 'dancer.ply', bytes: encodePly(SET) }]);
    await waitForScene(page, 'dancer.ply');
    expect(await textOf(page, 'scene-time-text')).toBe('0.00');
  });

  it('is saved with its motion as a PLY, and as it is shown in formats without one', async () => {
    const page = await shareViewer(CHEAP, { viewport: { width: 480, height: 320 } });
    await dropFiles(page, [{ name: 'dancer.ply', bytes: encodePly(SET) }]);
    await waitForScene(page, 'dancer.ply');
    await page.getByTestId('scene-time').fill('0.5');
    await openSaveTab(page, 'file');
    const saved = async (format: string) => {
      await press(page, `save-${format}`);
      const downloading = page.waitForEvent('download');
      await press(page, 'save-file');
      return readSplats(await readFile(await (await downloading).path()));
    };
    expect((await saved('ply')).motion).toHaveLength(15 * SET.count);
    const frozen = await saved('spz');
    expect(frozen.motion).toBeUndefined();
    expect(frozen.count).toBeLessThan(SET.count);
    await expect
      .poll(() => page.locator('.messages').innerText())
      .toMatch(/The scene moves, which .spz cannot hold/);
  });
});

/** A crowd of splats that moves to the right as a whole, larger than the first request for a file of frames. */
async function framesFile(): Promise<Uint8Array<ArrayBuffer>> {
  const count = 5000;
  // Of even spread, as random numbers are.
  const part = (i: number) => (i * 0.754_877_666) % 1;
  const sizes = Array.from({ length: 3 * count }, (_, i) => 0.02 + 0.02 * part(7 * i));
  const colors = Array.from({ length: 3 * count }, (_, i) => part(11 * i));
  const writer = await openFrameWriter({ framesPerS: FRAMES_PER_S, keyEvery: 4 });
  for (let frame = 0; frame < FRAMES; frame++) {
    const positions = Array.from({ length: count }, (_, i) => [
      part(i) + 0.25 * frame,
      part(i * i),
      part(3 * i),
    ]);
    await writer.add(
      splatsFromArrays({ positions: positions.flat(), scales: new Float32Array(sizes), colors }),
    );
  }
  const parts: Uint8Array<ArrayBuffer>[] = [];
  await writer.finish(async (bytes) => void parts.push(bytes));
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

describe('a file of frames', () => {
  const WINDOW = { viewport: { width: 480, height: 320 } };
  const picture = (page: Page) => viewerScreenshot(page, IMAGE_ALONE);
  /** Shows the frame at a time, and waits for its picture. */
  const showTime = async (page: Page, timeS: number) => {
    await page.getByTestId('scene-time').fill(String(timeS));
    await page.locator('[data-testid=time-bar]:not([data-awaited])').waitFor();
    await page.waitForFunction(isAtRestAfter, 0);
  };

  it('is scrubbed and played, again and again, and by keys', async () => {
    const page = await shareViewer(CHEAP, WINDOW);
    await dropFiles(page, [{ name: 'dance.frames', bytes: DANCE }]);
    await waitForScene(page, 'dance.frames');
    expect(await page.getByTestId('scene').innerText()).not.toMatch(/first of its/);
    const time = page.getByTestId('scene-time');
    expect(await time.getAttribute('max')).toBe('2');
    const first = await picture(page);
    await showTime(page, 1);
    expect(await textOf(page, 'scene-time-text')).toBe('1.00');
    const fifth = await picture(page);
    expect(changedPart(first, fifth)).toBeGreaterThan(0.1);
    // A frame on.
    await time.focus();
    await page.keyboard.press('ArrowRight');
    expect(await textOf(page, 'scene-time-text')).toBe('1.25');
    await showTime(page, 1.25);
    expect(changedPart(fifth, await picture(page))).toBeGreaterThan(0.05);
    await showTime(page, 0);
    expect(changedPart(first, await picture(page))).toBe(0);

    await page.getByTestId('play-scene').focus();
    await page.keyboard.press('Enter');
    const seen: number[] = [];
    const isAround = () => seen.some((each, i) => each < seen[i - 1] - 1);
    await expect
      .poll(
        async () => {
          seen.push(Number(await time.inputValue()));
          return isAround();
        },
        { interval: 50 },
      )
      .toBe(true);
    await page.keyboard.press('Enter');
    expect(await page.getByTestId('play-scene').getAttribute('aria-label')).toBe('Play the scene');
    await showTime(page, 1);
    expect(changedPart(fifth, await picture(page))).toBe(0);
  });

  it('of a server is shown before its last bytes are there, and says how many are', async () => {
    harness.server.answerFiles('hold', /dance\.frames$/);
    harness.server.answerParts('hold');
    const page = await harness.openViewer(`?src=dance.frames&${CHEAPLY}`, WINDOW);
    expect(await page.getByTestId('scene-title').innerText()).toBe('dance.frames');
    const first = await picture(page);
    await page.getByTestId('scene-time').fill('1');
    await page.locator('[data-testid=time-bar][data-awaited]').waitFor();
    await expect.poll(() => textOf(page, 'frame-load')).toMatch(/^\d.* of \d.* kB · .*B\/s$/);
    harness.server.answerFiles('send', /./);
    harness.server.answerParts('send');
    await showTime(page, 1);
    expect(changedPart(first, await picture(page))).toBeGreaterThan(0.1);
    await page.getByTestId('frame-load').waitFor({ state: 'detached' });
  });

  it('shows the frame before a damaged one, and says which one that is', async () => {
    const damaged = DANCE.slice();
    // Within the last frame.
    damaged[damaged.length - 50] ^= 1;
    const page = await shareViewer(CHEAP, WINDOW);
    await dropFiles(page, [{ name: 'hurt.frames', bytes: damaged }]);
    await waitForScene(page, 'hurt.frames');
    await showTime(page, 1.5);
    const sixth = await picture(page);
    await page.getByTestId('scene-time').fill('1.75');
    const message = page.getByTestId('error');
    await message.waitFor();
    expect(await message.innerText()).toMatch(/hurt\.frames is damaged.*frame 7 .*CRC-32.*frame before/s);
    await page.getByRole('button', { name: 'Dismiss' }).click();
    expect(changedPart(sixth, await picture(page))).toBe(0);
    await showTime(page, 0.5);
    expect(changedPart(sixth, await picture(page))).toBeGreaterThan(0.1);
  });

  it('is read again at the frame that is shown, for settings that need more of it', async () => {
    const page = await shareViewer(CHEAP, WINDOW);
    await dropFiles(page, [{ name: 'dance.frames', bytes: DANCE }]);
    await waitForScene(page, 'dance.frames');
    // The panel covers the time bar of so small a window.
    const choose = async (precision: GeometryPrecision) => {
      await page.keyboard.press('c');
      await press(page, 'accuracy-tab-settings');
      await redraw(page, () => page.getByTestId('setting-geometryPrecision').selectOption(precision));
      await page.keyboard.press('c');
    };
    await choose('f32');
    const fine = await picture(page);
    await showTime(page, 1.25);
    const sixth = await picture(page);
    expect(changedPart(fine, sixth)).toBeGreaterThan(0.1);
    await choose('packed');
    await expect.poll(async () => changedPart(sixth, await picture(page), 0)).toBeGreaterThan(0);
    await choose('f32');
    await expect.poll(async () => changedPart(sixth, await picture(page), 0)).toBe(0);
  });

  it('is saved as the frame that is shown', async () => {
    const page = await shareViewer(CHEAP, { viewport: { width: 480, height: 320 } });
    await dropFiles(page, [{ name: 'dance.frames', bytes: DANCE }]);
    await waitForScene(page, 'dance.frames');
    await showTime(page, 1.25);
    await openSaveTab(page, 'file');
    await press(page, 'save-ply');
    const downloading = page.waitForEvent('download');
    await press(page, 'save-file');
    const { count, positions, origin } = await readSplats(await readFile(await (await downloading).path()));
    expect(count).toBe(5000);
    // One axis is turned upright.
    expect(origin[0] + Math.min(...positions.filter((_, i) => i % 3 === 0))).toBeCloseTo(1.25, 2);
    await expect
      .poll(() => page.locator('.messages').innerText())
      .toMatch(/the frame that is shown is saved, 6 of 8/);
  });
});
