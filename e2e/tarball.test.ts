import { encodePly, perspectiveCamera } from '@websplatter/core';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { launchBrowser, newWatchedPage } from './browser.ts';
import { type FreshApp, makeFreshApp } from './fresh-app.ts';
import { MIN_PSNR_DB, referenceImage } from './reference.ts';
import { type Screenshot, screenshot } from './screenshot.ts';
import { slowDisplay } from './slow-display.ts';
import { testScene } from './test-scene.ts';

let app: FreshApp;
let browser: Browser;

beforeAll(async () => {
  [app, browser] = await Promise.all([
    makeFreshApp({ 'scene.ply': encodePly(testScene()) }),
    launchBrowser(),
  ]);
});

afterAll(async () => {
  await browser?.close();
  await app?.remove();
});

describe('the packed tarballs in a fresh Vite app', () => {
  it('type-check, strictly and down to the last declaration', async () => {
    await app.run('typescript/bin/tsc', ['--noEmit']);
  });

  it('build, and show splats that a worker has read', async () => {
    await app.run('vite/bin/vite.js', ['build', '--logLevel', 'warn']);
    await expectSplats('preview');
  });

  it('show splats under the development server, without any configuration, and as they are edited', async () => {
    await expectSplats('dev', async (page) => {
      // Fast Refresh keeps the Canvas and its renderer; if an effect ran anew, it would read the file again.
      await page.evaluate(() => Object.assign(document.querySelector('canvas')!, { isOfBefore: true }));
      await app.edit('src/app.tsx', '<Splats src', '<Splats opacity={0} src');
      await expect.poll(async () => isAllWhite(await screenshot(page))).toBe(true);
      expect(await page.evaluate(() => 'isOfBefore' in document.querySelector('canvas')!)).toBe(true);
    });
  });
});

/** Checks the app under one of Vite's servers: the right image, read by a worker, without warnings or errors. */
async function expectSplats(
  command: 'dev' | 'preview',
  goOn: (page: Page) => Promise<void> = async () => {},
): Promise<void> {
  const server = await app.serve(command);
  const { page, problems } = await newWatchedPage(browser, {});
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
    await page.goto(server.url);
    // Defaults of a Canvas.
    const camera = perspectiveCamera({
      position: [0, 0, 5],
      target: [0, 0, 0],
      fovYDegrees: 75,
      aspect: 480 / 320,
      near: 0.1,
      far: 1000,
    });
    const drawn = {
      viewMatrix: Array.from(camera.viewMatrix),
      projectionMatrix: Array.from(camera.projectionMatrix),
      near: 0.1,
      far: 1000,
      modelMatrices: [null],
      background: [1, 1, 1] as [number, number, number],
    };
    const psnrDb = referenceImage(drawn, [testScene()], { widthPx: 480, heightPx: 320 });
    await expect
      .poll(async () => psnrDb(await screenshot(page)), { interval: 250 })
      .toBeGreaterThanOrEqual(MIN_PSNR_DB);
    await goOn(page);
    // If the worker does not start, the page reads the file itself and looks just the same.
    const replies = await page.evaluate(() => (window as unknown as { replies: string[] }).replies);
    expect(replies.filter((kind) => kind === 'cloud')).toHaveLength(1);
    expect(problems).toEqual([]);
  } finally {
    await page.context().close();
    await server.close();
  }
}

function isAllWhite({ data }: Screenshot): boolean {
  return data.every((value) => value === 255);
}
