import { encodePly, perspectiveCamera } from '@websplatter/core';
import type { Browser } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { launchBrowser, newWatchedPage } from './browser.ts';
import { type FreshApp, makeFreshApp } from './fresh-app.ts';
import { MIN_PSNR_DB, referencePicture } from './reference.ts';
import { screenshot } from './screenshot.ts';
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

  it('show splats under the development server, without any configuration', async () => {
    await expectSplats('dev');
  });
});

/** Looks at the app under one of Vite's servers: the right picture, read by a worker, and nothing to complain about. */
async function expectSplats(command: 'dev' | 'preview'): Promise<void> {
  const server = await app.serve(command);
  const { page, problems } = await newWatchedPage(browser, {});
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
    // What a Canvas has unless told otherwise.
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
    const psnrDb = referencePicture(drawn, [testScene()], { widthPx: 480, heightPx: 320 });
    await expect
      .poll(async () => psnrDb(await screenshot(page)), { timeout: 60_000, interval: 250 })
      .toBeGreaterThanOrEqual(MIN_PSNR_DB);
    // Where the worker does not start, the page reads by itself and looks just the same.
    const replies = await page.evaluate(() => (window as unknown as { replies: string[] }).replies);
    expect(replies.filter((kind) => kind === 'cloud')).toHaveLength(1);
    expect(problems).toEqual([]);
  } finally {
    await page.context().close();
    await server.close();
  }
}
