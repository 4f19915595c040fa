// Proves: a poster in a server's HTML: hydrated, shown until the first complete frame, after losses, without
// WebGPU.
import { encodePly } from '@websplatter/core';
import type { BrowserContextOptions, Page } from 'playwright-core';
import { createElement } from 'react';
import { renderToString } from 'react-dom/server';
import { expect, it } from 'vitest';
import { holdRequests } from './browser.ts';
import { appHarness } from './harness.ts';
import { PosterPage } from './poster/poster-page.tsx';
import { skipRecoveryWaits } from './recovery-waits.ts';
import { MIN_PSNR_DB, referenceImage } from './reference.ts';
import { screenshot } from './screenshot.ts';
import { testScene } from './test-scene.ts';
import type { DrawnCamera } from './viewer-page.ts';

/** Of the poster, which no splat has. */
const GREEN = [0, 255, 0];
/** A GIF of one pixel, which covers any canvas. */
const poster = Buffer.from('R0lGODlhAQABAIAAAAD/AAAAACwAAAAAAQABAAACAkQBADs=', 'base64');
const harness = appHarness('e2e/poster', { 'a.ply': encodePly(testScene()), 'poster.gif': poster });

/** What a page of the poster did. */
interface Witness {
  /** Times that a poster left the page. */
  readonly departures: number;
  /** Animations that were begun. */
  readonly fades: number;
}

/** For `addInitScript`. */
function watch(): void {
  const witness = { departures: 0, fades: 0 };
  Object.assign(window, { witness });
  const { animate } = Element.prototype;
  Element.prototype.animate = function (...options) {
    witness.fades++;
    return animate.apply(this, options);
  };
  new MutationObserver((records) => {
    for (const node of records.flatMap(({ removedNodes }) => [...removedNodes]))
      if (node instanceof Element && node.querySelector('img')) witness.departures++;
  }).observe(document, { childList: true, subtree: true });
}

const witnessOf = (page: Page) => page.evaluate(() => (window as unknown as { witness: Witness }).witness);

/**
 * Opens the page as a server renders it, without the policy of other tests, which forbids styles in
 * HTML. Its splats arrive once the returned function is called.
 */
async function openServed(
  options: BrowserContextOptions = {},
  before: () => void = () => {},
): Promise<{ page: Page; sendSplats: () => void }> {
  const page = await harness.sharedPage(options, [watch, before]);
  const served = renderToString(createElement(PosterPage));
  await page.route(harness.server.url, async (route) => {
    const response = await route.fetch();
    const body = (await response.text()).replace('<div id="root">', `$&${served}`);
    await route.fulfill({ body, contentType: 'text/html' });
  });
  const sendSplats = await holdRequests(page, '**/a.ply');
  await page.goto(harness.server.url);
  return { page, sendSplats };
}

const posterOf = (page: Page) => page.getByRole('img', { name: 'Splats from afar' });

/** Waits for the Canvas to draw: a frame without splats, since their file is held. */
const untilCanvas = (page: Page, count = 1) =>
  page.waitForFunction((least) => window.served?.canvases.length >= least, count);

/** Share of the canvas's pixels that have the poster's colour. */
async function greenPart(page: Page): Promise<number> {
  const { data } = await screenshot(page.locator('canvas'));
  const pixels = Array.from({ length: data.length / 4 }, (_, i) => data.subarray(4 * i, 4 * i + 3));
  return pixels.filter((pixel) => GREEN.every((value, c) => pixel[c] === value)).length / pixels.length;
}

/** Compares pictures with what float64 draws, which takes longer than a page: the same in every test. */
let psnrDb: ReturnType<typeof referenceImage> | null = null;

/** PSNR of the canvas against its splats in float64. */
async function psnrOf(page: Page): Promise<number> {
  const shot = await screenshot(page.locator('canvas'));
  psnrDb ??= referenceImage(await drawnCamera(page), [testScene()], shot);
  return psnrDb(shot);
}

/** The camera of the newest Canvas, which nothing moves. */
async function drawnCamera(page: Page): Promise<DrawnCamera> {
  const camera = await page.evaluate(() => {
    const { camera } = window.served.canvases.at(-1)!;
    const [viewMatrix, projectionMatrix] = [camera.matrixWorldInverse, camera.projectionMatrix];
    return { viewMatrix: viewMatrix.toArray(), projectionMatrix: projectionMatrix.toArray() };
  });
  return { ...camera, near: 0.1, far: 100, modelMatrices: [null], background: [0, 0, 0] };
}

it('is in the HTML of the server, and shown where no script runs', async () => {
  const { page } = await openServed({ javaScriptEnabled: false });
  // The padding of the page's Canvas is not covered.
  expect(await posterOf(page).boundingBox()).toEqual({ x: 16, y: 0, width: 448, height: 312 });
  const { data } = await screenshot(page);
  const at = (x: number, y: number) => [...data.subarray(4 * (480 * y + x), 4 * (480 * y + x) + 3)];
  expect([at(15, 10), at(16, 0), at(463, 311), at(240, 312)]).toEqual([
    [255, 255, 255],
    GREEN,
    GREEN,
    [255, 255, 255],
  ]);
});

it('covers the canvas until its splats are there, which are then those of float64', async () => {
  const { page, sendSplats } = await openServed();
  await untilCanvas(page);
  expect(await greenPart(page)).toBe(1);
  sendSplats();
  await posterOf(page).waitFor({ state: 'detached' });
  expect(await psnrOf(page)).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  expect(await witnessOf(page)).toEqual({ departures: 1, fades: 0 });
});

it('fades, unless less motion is asked for', async () => {
  const { page, sendSplats } = await openServed({ reducedMotion: 'no-preference' });
  sendSplats();
  await posterOf(page).waitFor({ state: 'detached' });
  expect(await witnessOf(page)).toEqual({ departures: 1, fades: 1 });
});

it('stays where the device is lost before, and does not come back where it is lost later', async () => {
  harness.expectProblem(/<SplatCanvas> was lost/);
  const { page, sendSplats } = await openServed();
  await untilCanvas(page);
  await page.evaluate(() => window.served.loseDevice());
  await untilCanvas(page, 2);
  expect(await greenPart(page)).toBe(1);
  sendSplats();
  await posterOf(page).waitFor({ state: 'detached' });
  await page.evaluate(() => window.served.loseDevice());
  await untilCanvas(page, 3);
  await expect.poll(() => psnrOf(page)).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  expect(await witnessOf(page)).toEqual({ departures: 1, fades: 0 });
});

it('stays below the words of SplatsErrorBoundary where there is no WebGPU', async () => {
  harness.expectProblem(/WebGpuUnavailableError/);
  const { page } = await openServed({}, () =>
    Object.defineProperty(Navigator.prototype, 'gpu', { value: undefined }),
  );
  const alert = page.getByRole('alert');
  await alert.waitFor();
  const { data } = await screenshot(page);
  expect([...data.subarray(4 * (480 * 10 + 240), 4 * (480 * 10 + 240) + 3)]).toEqual(GREEN);
  const { y, height } = (await alert.boundingBox())!;
  expect(y).toBeGreaterThan(160);
  expect(y + height).toBeLessThanOrEqual(320);
  expect(await witnessOf(page)).toEqual({ departures: 0, fades: 0 });
});

it('comes back, with these words, where no device is to be had any more', async () => {
  harness.expectProblem(/<SplatCanvas> was lost/);
  harness.expectProblem(/WebGpuUnavailableError/);
  const { page, sendSplats } = await openServed({}, skipRecoveryWaits);
  sendSplats();
  await posterOf(page).waitFor({ state: 'detached' });
  await page.evaluate(() => {
    GPU.prototype.requestAdapter = async () => null;
    window.served.loseDevice();
  });
  await page.getByRole('alert').waitFor();
  await posterOf(page).waitFor();
});
