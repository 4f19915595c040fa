import { type Camera, cameraFromMatrices, encodePly } from '@websplatter/core';
import { compareImages, renderReference } from '@websplatter/core/reference';
import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { launchBrowser, newWatchedPage, type WatchedPage } from './browser.ts';
import { startViewerServer, type ViewerServer } from './server.ts';
import { testScene } from './test-scene.ts';
import {
  changedPart,
  type DrawnCamera,
  drawnCamera,
  dropFiles,
  frameCount,
  type Screenshot,
  screenshot,
  waitForFrameAfter,
  waitForPicture,
  waitForState,
} from './viewer-page.ts';

/**
 * Least PSNR of a screenshot against float64, both rounded to the screen's 8 bits. Packed geometry, 8-bit spherical
 * harmonics and half-float blending flip the rounding of single pixels: 68 dB were measured on SwiftShader. Another GPU
 * may filter and round otherwise, hence the margin; the same scene the other way up reaches 15 dB.
 */
const MIN_PSNR_DB = 45;

let browser: Browser;
let server: ViewerServer;
let watched: WatchedPage | null = null;

beforeAll(async () => {
  [browser, server] = await Promise.all([launchBrowser(), startViewerServer()]);
});

afterAll(async () => {
  await browser?.close();
  await server?.close();
});

afterEach(async () => {
  const { page, problems } = watched ?? { page: null, problems: [] };
  watched = null;
  await page?.context().close();
  expect(problems, 'what the page complained about').toEqual([]);
});

/** A page that has not gone anywhere yet. */
async function newPage(options: BrowserContextOptions = {}): Promise<Page> {
  watched = await newWatchedPage(browser, options);
  return watched.page;
}

/** The viewer with its first picture on the screen. */
async function openViewer(options: BrowserContextOptions = {}): Promise<Page> {
  const page = await newPage(options);
  await page.goto(`${server.url}?scene=still-life-small`);
  await waitForPicture(page);
  return page;
}

async function textOf(page: Page, testId: string): Promise<string> {
  return (await page.getByTestId(testId).textContent()) ?? '';
}

/** PSNR of a screenshot against the test scene in float64, from the camera that the viewer says it used. */
function psnrAgainstReference(shot: Screenshot, drawn: DrawnCamera): number {
  const { widthPx, heightPx, data } = shot;
  const { viewMatrix, projectionMatrix, near, far, modelMatrix, background } = drawn;
  const camera: Camera = cameraFromMatrices(viewMatrix, projectionMatrix, { near, far });
  const clouds = [{ set: testScene(), modelMatrix: modelMatrix ?? undefined }];
  const reference = renderReference({ clouds, camera, widthPx, heightPx });
  const actual = Float64Array.from(data, (value) => value / 255);
  return compareImages(actual, reference.data, { widthPx, heightPx, background, quantize: 'png' }).psnrDb;
}

describe('viewer', () => {
  it('opens on its scene, with the figures of each stage', async () => {
    const page = await openViewer();
    expect(await page.title()).toContain('Still life');
    const shot = await screenshot(page);
    const colors = new Set<number>();
    for (let i = 0; i < shot.data.length; i += 4) {
      colors.add((shot.data[i] << 16) | (shot.data[i + 1] << 8) | shot.data[i + 2]);
    }
    expect(colors.size, 'different colours').toBeGreaterThan(500);
    await page.waitForFunction(
      () => Number(document.querySelector('[data-testid=total-ms]')?.textContent) > 0,
    );
    for (const stage of ['preprocess-ms', 'sort-ms', 'rasterize-ms', 'total-ms']) {
      expect(Number((await textOf(page, stage)).replaceAll(',', '')), stage).toBeGreaterThan(0);
    }
    expect(await textOf(page, 'timing-source')).toBe('GPU timestamps');
    expect(await textOf(page, 'loaded-splats')).toBe('10,000');
    const visible = Number((await textOf(page, 'visible-splats')).replaceAll(',', ''));
    expect(visible).toBeGreaterThan(1000);
    expect(visible).toBeLessThanOrEqual(10_000);
    expect(await textOf(page, 'adapter')).toMatch(/swiftshader/i);
    expect(await textOf(page, 'resolution')).toBe('480 × 320');
  });

  it('shows a PLY that is dropped, as the float64 reference does', async () => {
    const page = await openViewer();
    const before = await screenshot(page);
    const frames = await frameCount(page);
    const file = { name: 'test scene.ply', bytes: encodePly(testScene()) };
    await dropFiles(page, [file], async () => {
      expect(await page.getByTestId('drop-overlay').isVisible()).toBe(true);
    });
    await waitForFrameAfter(page, frames);
    await waitForState(page, 'ready');
    expect(await page.getByTestId('drop-overlay').isVisible()).toBe(false);
    expect(await textOf(page, 'scene-title')).toBe('test scene.ply');
    expect(await textOf(page, 'scene')).toContain('400 splats');
    expect(await page.title()).toContain('test scene.ply');

    const shot = await screenshot(page);
    expect(changedPart(before, shot)).toBeGreaterThan(0.3);
    const drawn = await drawnCamera(page);
    // Files come with y down, as captures do, and are turned.
    expect(drawn.modelMatrix?.[5]).toBe(-1);
    expect(psnrAgainstReference(shot, drawn)).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    // The comparison can fail: the same picture against the scene the other way up.
    expect(psnrAgainstReference(shot, { ...drawn, modelMatrix: null })).toBeLessThan(MIN_PSNR_DB);

    const framesBeforeFlip = await frameCount(page);
    await page.keyboard.press('u');
    await waitForFrameAfter(page, framesBeforeFlip);
    const flipped = await drawnCamera(page);
    expect(flipped.modelMatrix).toBeNull();
    expect(psnrAgainstReference(await screenshot(page), flipped)).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('keeps the old scene on the screen, and movable, while a file is loading', async () => {
    const page = await newPage();
    await page.addInitScript(() => {
      const target = window as unknown as { isHolding: boolean; release: () => void };
      const post = Worker.prototype.postMessage;
      // Holds the loading worker's job back for as long as the test likes.
      Worker.prototype.postMessage = function (this: Worker, ...message: unknown[]) {
        const send = () => Reflect.apply(post, this, message);
        if (target.isHolding) target.release = send;
        else send();
      };
    });
    await page.goto(`${server.url}?scene=still-life-small`);
    await waitForPicture(page);
    await page.evaluate(() => Object.assign(window, { isHolding: true }));
    await dropFiles(page, [{ name: 'later.ply', bytes: encodePly(testScene()) }]);
    await page.waitForFunction(() => 'release' in window);
    expect(await page.getByTestId('load').isVisible()).toBe(true);

    const before = await screenshot(page);
    const frames = await frameCount(page);
    await page.keyboard.press('ArrowRight');
    await waitForFrameAfter(page, frames);
    expect(changedPart(before, await screenshot(page))).toBeGreaterThan(0.05);
    expect(await textOf(page, 'scene-title')).toContain('Still life');
    await waitForState(page, 'loading');

    await page.evaluate(() => (window as unknown as { release: () => void }).release());
    await waitForState(page, 'ready');
    expect(await textOf(page, 'scene-title')).toBe('later.ply');
  });

  it('opens the first PLY of several and says so', async () => {
    const page = await openViewer();
    const bytes = encodePly(testScene());
    await dropFiles(page, [
      { name: 'readme.txt', bytes: new Uint8Array(3) },
      { name: 'a.ply', bytes },
      { name: 'b.ply', bytes },
    ]);
    await page.getByTestId('scene-title').getByText('a.ply').waitFor();
    expect(await textOf(page, 'notice')).toContain('One scene at a time');
  });

  it('says what is wrong with a file that is cut off, and keeps the scene', async () => {
    const page = await openViewer();
    const before = await screenshot(page);
    const bytes = encodePly(testScene());
    await dropFiles(page, [{ name: 'cut.ply', bytes: bytes.subarray(0, Math.floor(bytes.length * 0.6)) }]);
    await waitForState(page, 'error');
    expect(await textOf(page, 'error')).toContain('incomplete');
    expect(await textOf(page, 'error-message')).toMatch(/cut\.ply.*vertex/);
    expect(await page.getByRole('alert').getByTestId('error').isVisible()).toBe(true);
    expect(await textOf(page, 'scene-title')).toContain('Still life');
    expect(changedPart(before, await screenshot(page), 0)).toBe(0);

    await page.getByTestId('dismiss-error').click();
    await waitForState(page, 'ready');
    expect(await page.getByTestId('error').count()).toBe(0);
  });

  it('says so where the address leads to no splats, and shows the built-in scene', async () => {
    const page = await newPage();
    await page.goto(`${server.url}?scene=still-life-small&file=index.html`);
    await page.getByTestId('error').waitFor();
    await waitForFrameAfter(page, 0);
    await waitForState(page, 'error');
    expect(await textOf(page, 'error')).toContain('Unknown file format');
    expect(await textOf(page, 'scene-title')).toContain('Still life');
  });

  it('draws in device pixels, also after the window has changed', async () => {
    const page = await openViewer({ viewport: { width: 200, height: 120 }, deviceScaleFactor: 2 });
    const backingSize = () =>
      page.getByTestId('viewport').evaluate((canvas: HTMLCanvasElement) => [canvas.width, canvas.height]);
    expect(await backingSize()).toEqual([400, 240]);
    const frames = await frameCount(page);
    await page.setViewportSize({ width: 150, height: 190 });
    await waitForFrameAfter(page, frames);
    expect(await backingSize()).toEqual([300, 380]);
    const { projectionMatrix } = await drawnCamera(page);
    expect(projectionMatrix[5] / projectionMatrix[0]).toBeCloseTo(150 / 190);
  });

  it('moves the view by keys, mouse and wheel, and goes back', async () => {
    const page = await openViewer();
    const start = await screenshot(page);
    const act = async (what: string, action: () => Promise<void>) => {
      const before = await screenshot(page);
      const frames = await frameCount(page);
      await action();
      await waitForFrameAfter(page, frames);
      const after = await screenshot(page);
      expect(changedPart(before, after), what).toBeGreaterThan(0.05);
      return after;
    };
    await act('arrow key', () => page.keyboard.press('ArrowRight'));
    await act('left drag', async () => {
      await page.mouse.move(240, 200);
      await page.mouse.down();
      await page.mouse.move(300, 190);
      await page.mouse.up();
    });
    await act('right drag', async () => {
      await page.mouse.down({ button: 'right' });
      await page.mouse.move(240, 220);
      await page.mouse.up({ button: 'right' });
    });
    await act('wheel', () => page.mouse.wheel(0, -240));
    const end = await act('reset', () => page.keyboard.press('r'));
    expect(changedPart(start, end, 0)).toBe(0);
  });

  it('says what is missing where there is no WebGPU', async () => {
    const page = await newPage();
    await page.addInitScript(() =>
      Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined }),
    );
    await page.goto(server.url);
    await waitForState(page, 'unavailable');
    const message = await textOf(page, 'webgpu-unavailable');
    expect(message).toContain('needs WebGPU');
    for (const name of ['Chrome', 'Safari', 'Firefox']) expect(message).toContain(name);
  });

  it('says so where there is WebGPU but no GPU for it', async () => {
    const page = await newPage();
    await page.addInitScript(() => {
      GPU.prototype.requestAdapter = async () => null;
    });
    await page.goto(server.url);
    await waitForState(page, 'unavailable');
    expect(await textOf(page, 'status-reason')).toContain('no GPU');
  });

  it('recovers the scene and the view after the device was lost', async () => {
    const page = await newPage();
    await page.addInitScript(() => {
      const requestDevice = GPUAdapter.prototype.requestDevice;
      GPUAdapter.prototype.requestDevice = async function (...options) {
        const device = await requestDevice.apply(this, options);
        addEventListener('lose-device', () => device.destroy(), { once: true });
        return device;
      };
    });
    await page.goto(`${server.url}?scene=still-life-small`);
    await waitForPicture(page);
    let frames = await frameCount(page);
    await page.keyboard.press('ArrowLeft');
    await waitForFrameAfter(page, frames);
    const before = await screenshot(page);

    await page.evaluate(() => dispatchEvent(new Event('lose-device')));
    await waitForState(page, 'lost');
    frames = await frameCount(page);
    await page.getByTestId('recover').click();
    await waitForState(page, 'ready');
    await waitForFrameAfter(page, frames);
    expect(changedPart(before, await screenshot(page), 0)).toBe(0);
  });

  it('draws nothing and asks for no frame while nothing happens', async () => {
    const page = await newPage();
    await page.addInitScript(() => {
      const request = requestAnimationFrame;
      const counter = window as unknown as { requestedFrames: number };
      counter.requestedFrames = 0;
      window.requestAnimationFrame = (callback) => {
        counter.requestedFrames++;
        return request(callback);
      };
    });
    await page.goto(`${server.url}?scene=still-life-small`);
    await waitForPicture(page);
    // The first measurement comes after the picture and asks whether there is more to draw.
    await page.waitForFunction(
      () => Number(document.querySelector('[data-testid=total-ms]')?.textContent) > 0,
    );
    const requested = () =>
      page.evaluate(() => (window as unknown as { requestedFrames: number }).requestedFrames);
    const framesBefore = await frameCount(page);
    const requestedBefore = await requested();
    await page.waitForTimeout(1000);
    expect(await frameCount(page)).toBe(framesBefore);
    expect(await requested()).toBe(requestedBefore);
    expect(requestedBefore).toBeGreaterThan(0);
  });

  it('stops a load that is cancelled, and shows the built-in scene in place of the file', async () => {
    const page = await newPage();
    await page.goto(`${server.url}?scene=still-life-small&file=/endless.ply`);
    await page.getByTestId('load-figures').getByText('of 100 MB').waitFor();
    expect(await page.evaluate(() => document.documentElement.dataset.state)).toBe('loading');
    await page.getByTestId('cancel-load').click();
    await server.whenEndlessFileIsDropped();
    await waitForPicture(page);
    expect(await textOf(page, 'scene-title')).toContain('Still life');
    expect(await page.getByTestId('load').count()).toBe(0);
    expect(await page.getByTestId('error').count()).toBe(0);
  });

  it('stops a load when another file is dropped', async () => {
    const page = await newPage();
    await page.goto(`${server.url}?file=/endless.ply`);
    await page.getByTestId('load-figures').getByText('of 100 MB').waitFor();
    await dropFiles(page, [{ name: 'next.ply', bytes: encodePly(testScene()) }]);
    await server.whenEndlessFileIsDropped();
    await waitForPicture(page);
    expect(await textOf(page, 'scene-title')).toBe('next.ply');
  });

  it('lists its keys and hides its figures', async () => {
    const page = await openViewer();
    await page.keyboard.press('?');
    expect(await page.getByTestId('help').isVisible()).toBe(true);
    await page.keyboard.press('Escape');
    await page.getByTestId('help').waitFor({ state: 'hidden' });
    await page.keyboard.press('h');
    await page.getByTestId('hud').waitFor({ state: 'detached' });
    await page.keyboard.press('h');
    await page.getByTestId('hud').waitFor();
    expect(await textOf(page, 'loaded-splats')).toBe('10,000');
  });
});
