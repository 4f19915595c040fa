// Proves: in Firefox by mouse and keys: selecting, stories in links, saved pages, videos, accuracy.
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { encodePly } from '@websplatter/core';
import type { Page } from '@websplatter/tools/firefox';
import { LONG_PATIENCE_MS } from '@websplatter/tools/patience';
import { expect } from 'vitest';
import { firefoxHarness } from './firefox-harness.ts';
import { click, pictureOf, redraw, savedFile, waitFor, waitForScene, waitUntil } from './firefox-viewer.ts';
import { playbackOf, playVideo } from './play-video.ts';
import { changedPart, colorsIn, psnrOf } from './screenshot.ts';
import { testScene } from './test-scene.ts';
import { CHEAPLY } from './viewer-page.ts';

const harness = firefoxHarness();
const { firefoxTest } = harness;
const PATIENTLY = { timeout: LONG_PATIENCE_MS };
/** A panel beside the picture. */
const WINDOW = { width: 700, height: 480 };
type Point = readonly [x: number, y: number];

async function openViewer(options = CHEAPLY): Promise<Page> {
  const files = { 'scene.ply': encodePly(testScene()) };
  const page = await harness.open('apps/viewer', `?src=scene.ply&${options}`, files);
  await page.setViewport(WINDOW);
  await waitForScene(page, 'scene.ply');
  // The figures cover a part of the picture.
  await page.keyboard.press('h');
  return page;
}

const has = (page: Page, testId: string) => waitFor(page, `[data-testid=${testId}]`);
/** Waits until an element takes what is typed. */
const takesKeys = (page: Page, testId: string) => waitFor(page, `[data-testid=${testId}]:focus`);
const text = (page: Page, testId: string) =>
  page.$eval(`[data-testid=${testId}]`, (element) => element.textContent ?? '');

async function pressWithControl(page: Page, key: string, shift = false): Promise<void> {
  const held = shift ? (['Control', 'Shift'] as const) : (['Control'] as const);
  for (const each of held) await page.keyboard.down(each);
  await page.keyboard.press(key as 'z');
  for (const each of held) await page.keyboard.up(each);
}

/** Runs a command that is found by a word. */
async function runCommand(page: Page, word: string): Promise<void> {
  await pressWithControl(page, 'k');
  await takesKeys(page, 'find-command');
  await page.keyboard.type(word);
  await page.keyboard.press('Enter');
}

/** The middle of the part of the picture that no panel covers. */
const middle = (page: Page): Promise<Point> =>
  page.$eval('.free-area', (area) => {
    const { x, y, width, height } = area.getBoundingClientRect();
    return [x + width / 2, y + height / 2] as const;
  });

async function drag(page: Page, [x, y]: Point, [right, down]: Point): Promise<void> {
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + right, y + down, { steps: 2 });
  await page.mouse.up();
}

const selectedCount = async (page: Page) =>
  Number((await text(page, 'select-count')).match(/^(\d+) of 400 splats are selected/)?.[1]);

firefoxTest('a polygon and a sphere select splats, which keys remove and bring back', async () => {
  const page = await openViewer();
  await redraw(page, () => runCommand(page, 'polygon'));
  await has(page, 'select-count');
  const whole = await pictureOf(page);
  const [x, y] = await middle(page);
  const side = 50;
  await redraw(page, async () => {
    await page.mouse.click(x - side, y - side);
    await page.mouse.click(x + side, y - side);
    await page.mouse.click(x, y + side);
    await page.keyboard.press('Enter');
  });
  await expect.poll(() => selectedCount(page), PATIENTLY).toBeGreaterThan(0);
  const inPolygon = await selectedCount(page);

  await page.keyboard.press('4');
  await has(page, 'select-middle');
  await redraw(page, () => drag(page, [x, y], [30, 20]));
  await expect.poll(() => selectedCount(page), PATIENTLY).not.toBe(inPolygon);
  const inSphere = await selectedCount(page);
  expect(inSphere).toBeGreaterThan(0);

  await redraw(page, () => page.keyboard.press('Delete'));
  await expect.poll(() => text(page, 'select-count')).toContain(`${inSphere} splats removed`);
  const removed = await pictureOf(page);
  expect(changedPart(whole, removed)).toBeGreaterThan(0.001);
  await redraw(page, () => pressWithControl(page, 'z'));
  expect(await selectedCount(page)).toBe(inSphere);
  await redraw(page, () => pressWithControl(page, 'z', true));
  expect(changedPart(removed, await pictureOf(page), 0)).toBe(0);
  for (const count of [inSphere, inPolygon, 0]) {
    await redraw(page, () => pressWithControl(page, 'z'));
    expect((await selectedCount(page)) || 0).toBe(count);
  }
  expect(changedPart(whole, await pictureOf(page), 0)).toBe(0);
});

firefoxTest('a link has the view that is saved and the annotation that is placed', async () => {
  const page = await openViewer();
  await page.keyboard.press('p');
  await has(page, 'placing');
  await page.mouse.click(...(await middle(page)));
  await takesKeys(page, 'annotation-title');
  await page.keyboard.type('The middle');
  await click(page, 'annotation-done');
  await click(page, 'close-annotation');
  await redraw(page, () => page.keyboard.press('ArrowLeft'));
  await redraw(page, () => page.keyboard.press('v'));
  await click(page, 'save-view');
  await click(page, 'saved-view-name-1');
  await takesKeys(page, 'saved-view-name-1');
  await page.keyboard.type('From the left');
  await redraw(page, () => page.keyboard.press('Escape'));
  for (const words of ['From+the+left', 'The+middle'])
    await waitUntil(page, (part) => location.href.includes(part), words);

  const linked = await harness.openAt(page.url());
  await linked.setViewport(WINDOW);
  await waitForScene(linked, 'scene.ply');
  expect(changedPart(await pictureOf(page), await pictureOf(linked), 0)).toBe(0);
  await redraw(linked, () => click(linked, 'annotation-1'));
  await has(linked, 'annotation');
  expect(await text(linked, 'annotation')).toContain('The middle');
  await redraw(linked, () => linked.keyboard.press('v'));
  await linked.waitForSelector('[data-testid=saved-view-name-1]');
  const name = await linked.$eval(
    '[data-testid=saved-view-name-1]',
    (field) => (field as HTMLInputElement).value,
  );
  expect(name).toBe('From the left');
});

firefoxTest('a page that the panel saves shows the picture of `?noui` from a disk', async () => {
  const view = `camera=0,0,0,4,0.5,1.2&${CHEAPLY}`;
  const page = await openViewer(view);
  await page.keyboard.press('x');
  await click(page, 'save-html');
  await savedFile(harness.folder, 'scene.html');
  await page.goto(`${new URL('.', page.url())}?src=scene.ply&noui&${view}`);
  await waitForScene(page, 'scene.ply');
  const opened = await harness.openAt(pathToFileURL(join(harness.folder, 'scene.html')).href);
  await opened.setViewport(WINDOW);
  await waitForScene(opened, 'scene.ply');
  const picture = await pictureOf(opened);
  expect(colorsIn(picture)).toBeGreaterThan(1000);
  expect(changedPart(picture, await pictureOf(page), 0)).toBe(0);
});

firefoxTest('the path through two saved views is a video, which Firefox makes and plays', async () => {
  const page = await openViewer();
  await page.setViewport({ width: 320, height: 240 });
  await redraw(page, () => page.keyboard.press('ArrowLeft'));
  const saveView = async () => {
    const picture = await pictureOf(page);
    await redraw(page, () => page.keyboard.press('v'));
    await click(page, 'save-view');
    await redraw(page, () => page.keyboard.press('v'));
    return picture;
  };
  const first = await saveView();
  await redraw(page, () => drag(page, [200, 80], [-80, 20]));
  const last = await saveView();
  await redraw(page, () => page.keyboard.press('x'));
  await click(page, 'save-tab-picture');
  await click(page, 'video-webm');
  await click(page, 'save-video');
  const video = await savedFile(harness.folder, 'scene.webm');
  const player = await harness.openAt('about:blank');
  const played = playbackOf(
    await player.evaluate(playVideo, { base64: video.toString('base64'), type: 'video/webm' }),
  );
  expect(played.durationS).toBeCloseTo(76 / 30, 2);
  expect(psnrOf(played.first, first)).toBeGreaterThan(25);
  expect(psnrOf(played.last, last)).toBeGreaterThan(25);
  expect(psnrOf(played.first, last)).toBeLessThan(25);
});

firefoxTest('the row of a preset shows its picture while the pointer is on it', async () => {
  const page = await openViewer('accuracy=balanced');
  await page.setViewport({ width: 400, height: 360 });
  await redraw(page, () => runCommand(page, 'accuracy'));
  await click(page, 'accuracy-tab-measure');
  await click(page, 'measure');
  await waitFor(page, '[data-testid=preset-fast] canvas');
  await has(page, 'measure');
  const before = await pictureOf(page);
  await page.hover('[data-testid=preset-fast]');
  await has(page, 'looked-picture');
  expect(changedPart(before, await pictureOf(page), 0)).toBeGreaterThan(0);
  await page.mouse.move(5, 200);
  await waitUntil(page, (each) => document.querySelector(each) === null, '[data-testid=looked-picture]');
  expect(changedPart(before, await pictureOf(page), 0)).toBe(0);
});
