import { readFile, stat } from 'node:fs/promises';
import { join } from 'node:path';
import type { Page } from '@websplatter/tools/firefox';
import { LONG_PATIENCE_MS } from '@websplatter/tools/patience';
import { expect } from 'vitest';
import { adoptStyle, screenshotOf } from './firefox-page.ts';
import type { Screenshot } from './screenshot.ts';
import {
  cameraOnScreen,
  type DrawnCamera,
  framesAtRest,
  IMAGE_ALONE,
  isAtRestAfter,
  isSceneAtRest,
  stateOfPage,
} from './viewer-page.ts';

const PATIENTLY = { timeout: LONG_PATIENCE_MS, interval: 100 };

/**
 * Waits until `isSo` returns true in the page. Polls from the test: Playwright's waits inside of
 * Firefox's pages, by mutations or by frames, have missed states.
 */
export async function waitUntil<Arg>(page: Page, isSo: (arg: Arg) => boolean, arg: Arg): Promise<void> {
  try {
    await expect.poll(() => page.evaluate(isSo as (arg: unknown) => boolean, arg), PATIENTLY).toBe(true);
  } catch (error) {
    const found = JSON.stringify(await page.evaluate(stateOfPage));
    throw new Error(`${JSON.stringify(arg)} did not come: ${isSo}. The page tells ${found}`, {
      cause: error,
    });
  }
}

/** Waits until an element is there. */
export function waitFor(page: Page, selector: string): Promise<void> {
  return waitUntil(page, (each) => document.querySelector(each) !== null, selector);
}

/** Waits until the picture at rest shows the scene with this title, and nothing is being loaded. */
export function waitForScene(page: Page, title: string): Promise<void> {
  return waitUntil(page, isSceneAtRest, { title, state: 'ready' });
}

/** Changes the viewer's picture in one step, and waits until the new one is at rest. */
export async function redraw(page: Page, act: () => Promise<unknown>): Promise<void> {
  await waitUntil(page, isAtRestAfter, 0);
  const frames = await page.evaluate(framesAtRest);
  await act();
  await waitUntil(page, isAtRestAfter, frames);
}

/** Style that hides the interface but keeps it under the pointer. */
const PICTURE_ALONE = IMAGE_ALONE.replace('visibility: hidden', 'opacity: 0');

export async function drawnCamera(page: Page): Promise<DrawnCamera> {
  return (await page.evaluate(cameraOnScreen))!;
}

/** Captures the picture without the interface over it. */
export async function pictureOf(page: Page): Promise<Screenshot> {
  await adoptStyle(page, PICTURE_ALONE);
  const picture = await screenshotOf(page, '[data-testid=viewport]');
  await page.evaluate(() => void document.adoptedStyleSheets.pop());
  return picture;
}

/** Clicks an element, once it is there and takes clicks, by the mouse. */
export async function click(page: Page, testId: string): Promise<void> {
  const selector = `[data-testid=${testId}]:not(:disabled)`;
  await waitFor(page, selector);
  await page.locator(selector).click();
}

/** Waits until Firefox has saved a file into a folder whole, and returns its bytes. */
export async function savedFile(folder: string, name: string): Promise<Buffer> {
  const path = join(folder, name);
  // An empty file holds the name until all is written elsewhere.
  const sizeBytes = () =>
    stat(path).then(
      ({ size }) => size,
      () => 0,
    );
  await expect.poll(sizeBytes, PATIENTLY).toBeGreaterThan(0);
  return readFile(path);
}
