import { perspectiveCamera } from '@websplatter/core';
import type { Browser, Page } from 'playwright-core';
import { expect } from 'vitest';
import { newWatchedPage } from './browser.ts';
import { drawnBy, MIN_PSNR_DB, referenceImage } from './reference.ts';
import { type Screenshot, screenshot } from './screenshot.ts';
import { slowDisplay } from './slow-display.ts';
import { testScene } from './test-scene.ts';

export interface ExpectSplatsOptions {
  /** Goes on with the page once it shows the right image. */
  readonly goOn?: (page: Page) => Promise<void>;
  /** Whether a worker reads the scene. Without one, the page reads the file and looks the same. */
  readonly hasWorker?: boolean;
  /** Warnings that the page must log, each once. */
  readonly warnings?: readonly RegExp[];
  /** Errors that the page may log. */
  readonly expected?: readonly RegExp[];
}

/** Software draws quickly in it. */
const VIEWPORT = { width: 240, height: 160 };

let compare: ReturnType<typeof referenceImage> | undefined;

/** Compares screenshots with `testScene` on a default Canvas in float64, drawn once for all. */
function psnrOfCanvas(shot: Screenshot): number {
  compare ??= referenceOfCanvas();
  return compare(shot);
}

function referenceOfCanvas(): ReturnType<typeof referenceImage> {
  const camera = perspectiveCamera({
    position: [0, 0, 5],
    target: [0, 0, 0],
    fovYDegrees: 75,
    aspect: VIEWPORT.width / VIEWPORT.height,
    near: 0.1,
    far: 1000,
  });
  const size = { widthPx: VIEWPORT.width, heightPx: VIEWPORT.height };
  return referenceImage(drawnBy(camera, [1, 1, 1]), [testScene()], size);
}

/** State of a page that does not show its scene, for the one who reads why a test failed. */
async function stateOf(page: Page): Promise<object> {
  const logged = (await page.consoleMessages()).map((message) => message.text());
  const state = await page.evaluate(async () => {
    const within = (promise: Promise<string>) =>
      Promise.race([promise, new Promise((resolve) => setTimeout(resolve, 5000, 'not within 5 s'))]);
    return {
      visibility: document.visibilityState,
      root: document.querySelector('#root')?.innerHTML,
      canvases: [...document.querySelectorAll('canvas')].map(
        ({ width, height, clientWidth, clientHeight }) => [width, height, clientWidth, clientHeight],
      ),
      replies: (window as unknown as { replies: string[] }).replies,
      frame: await within(new Promise((resolve) => requestAnimationFrame(() => resolve('drawn')))),
      adapter: await within(navigator.gpu.requestAdapter().then((adapter) => String(adapter))),
    };
  });
  return { ...state, logged };
}

/**
 * Checks that the page at `url` shows `testScene` as a Canvas does by default: the right image,
 * read by a worker, without errors.
 */
export async function expectSplats(
  browser: Browser,
  url: string,
  { goOn = async () => {}, hasWorker = true, warnings = [], expected = [] }: ExpectSplatsOptions = {},
): Promise<void> {
  const { page, problems: all } = await newWatchedPage(browser, { viewport: VIEWPORT });
  const problems = () => all.filter((problem) => !expected.some((pattern) => pattern.test(problem)));
  const warned: string[] = [];
  page.on('console', (message) => {
    if (message.type() === 'warning') warned.push(message.text());
  });
  const pending = new Set<string>();
  page.on('request', (request) => pending.add(request.url()));
  page.on('requestfinished', (request) => pending.delete(request.url()));
  page.on('requestfailed', (request) => pending.delete(request.url()));
  await page.addInitScript(slowDisplay);
  await page.addInitScript(() => {
    const replies: string[] = [];
    Object.assign(window, { replies });
    window.Worker = class extends Worker {
      constructor(...options: ConstructorParameters<typeof Worker>) {
        super(...options);
        this.addEventListener('message', ({ data }) => replies.push(data.kind));
      }
    };
  });
  try {
    await page.goto(url);
    await expect
      .poll(
        async () => Math.max(psnrOfCanvas(await screenshot(page)), problems().length > 0 ? Infinity : 0),
        {
          interval: 250,
        },
      )
      .toBeGreaterThanOrEqual(MIN_PSNR_DB)
      .catch(async (error: Error) => {
        error.message += `\nThe page: ${JSON.stringify({ ...(await stateOf(page)), pending: [...pending] })}`;
        throw error;
      });
    expect(problems()).toEqual([]);
    await goOn(page);
    const replies = await page.evaluate(() => (window as unknown as { replies: string[] }).replies);
    expect(replies.filter((kind) => kind === 'cloud')).toHaveLength(hasWorker ? 1 : 0);
    for (const warning of warnings) expect(warned.filter((text) => warning.test(text))).toHaveLength(1);
    if (hasWorker) expect(warned.filter((text) => text.includes('load-worker'))).toEqual([]);
    expect(problems()).toEqual([]);
  } finally {
    await page.context().close();
  }
}
