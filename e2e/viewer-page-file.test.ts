// Proves: a scene saved as one web page, and as a zip for web hosts.
import { mkdir, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { encodePly } from '@websplatter/core';
import { serveFiles } from '@websplatter/tools/file-server';
import type { Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { openZipEntry, readZipDirectory } from '../packages/core/src/io/containers/zip.ts';
import { holdRequests } from './browser.ts';
import { colorsIn } from './screenshot.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAPLY,
  drawnCamera,
  redraw,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForImage,
  waitForNotice,
} from './viewer-page.ts';

const harness = viewerHarness();
const WINDOW = { viewport: { width: 320, height: 240 } };
let folder = '';

beforeAll(async () => {
  folder = await mkdtemp(join(tmpdir(), 'websplatter-page-'));
});
afterAll(() => rm(folder, { recursive: true, force: true }));

/** Saves the scene that is shown as a page, or a zip of one, by the panel; returns its path. */
async function savePage(page: Page, kind: 'html' | 'zip' = 'html'): Promise<string> {
  await page.keyboard.press('x');
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByTestId(`save-${kind}`).click(),
  ]);
  const path = join(folder, download.suggestedFilename());
  await download.saveAs(path);
  return path;
}

/** Opens a saved page from the disk, without a network. */
async function openFile(path: string, script = () => {}): Promise<Page> {
  const page = await harness.newPage(WINDOW);
  await page.context().setOffline(true);
  await page.addInitScript(script);
  await page.goto(pathToFileURL(path).href);
  return page;
}

describe('a scene that is saved as one web page', () => {
  it('shows the picture of `?noui` from a disk, bit for bit, and can be moved', async () => {
    const viewer = await harness.newPage(WINDOW);
    const [a, b] = [testScene(), testScene(100)].map((scene) => Buffer.from(encodePly(scene)));
    await viewer.route('**/first.ply', (route) => route.fulfill({ body: a }));
    await viewer.route('**/second.ply', (route) => route.fulfill({ body: b }));
    const address = `?src=first.ply&src=second.ply&place=&place=move:0.3:0:0,opacity:0.5&${CHEAPLY}`;
    await viewer.goto(`${harness.server.url}${address}&effects=brightness:0.2`);
    await waitForImage(viewer);
    await redraw(viewer, () => viewer.keyboard.press('ArrowLeft'));
    const path = await savePage(viewer);
    expect(path).toMatch(/first-and-second\.html$/);
    await waitForNotice(viewer, 'Saved first-and-second.html');
    const link = await viewer.getByTestId('link').inputValue();
    expect(await viewer.getByTestId('frame').inputValue()).toMatch(
      /^<iframe src="http[^"]*&amp;noui" title="first.ply and second.ply" /,
    );
    await viewer.goto(`${link}&noui`);
    await waitForImage(viewer);

    const page = await openFile(path);
    await waitForImage(page);
    expect(await page.title()).toBe('first.ply and second.ply');
    expect(await drawnCamera(page)).toEqual(await drawnCamera(viewer));
    const picture = await viewerScreenshot(page);
    expect(colorsIn(picture)).toBeGreaterThan(1000);
    expect(picture).toEqual(await viewerScreenshot(viewer));
    expect(await page.getByRole('toolbar').count()).toBe(0);

    const camera = await drawnCamera(page);
    await redraw(page, () => page.mouse.wheel(0, 100));
    await redraw(page, () => page.keyboard.press('ArrowRight'));
    expect((await drawnCamera(page)).viewMatrix).not.toEqual(camera.viewMatrix);
  });

  it('holds built-in scenes and annotations, and says where there is no WebGPU', async () => {
    const annotation = 'annotation=0:0.2:0,0,0.2,0,2,0,1.4,words:The+vase%0AOld.';
    const viewer = await harness.openViewer(`?scene=still-life-small&${CHEAPLY}&${annotation}`, WINDOW);
    const path = await savePage(viewer);
    await viewer.goto(`${await viewer.getByTestId('link').inputValue()}&noui`);
    await waitForImage(viewer);
    const page = await openFile(path);
    await waitForImage(page);
    expect(await viewerScreenshot(page)).toEqual(await viewerScreenshot(viewer));
    await page.getByTestId('annotation-1').click();
    expect(await textOf(page, 'annotation')).toContain('Old.');

    const without = await openFile(path, () => {
      Object.defineProperty(navigator, 'gpu', { value: undefined });
    });
    await without.getByText('This page needs WebGPU').waitFor();
  });
});

/** Unpacks a zip beside it; returns the folder. */
async function unpacked(path: string): Promise<string> {
  const bytes = new Uint8Array(await readFile(path));
  for (const entry of readZipDirectory(bytes, path)) {
    const target = join(`${path}.d`, entry.path);
    await mkdir(dirname(target), { recursive: true });
    await writeFile(target, openZipEntry(bytes, entry, path).stream);
  }
  return `${path}.d`;
}

describe('a scene that is saved as a zip', () => {
  it('shows the same picture from any web host, and its own picture until then', async () => {
    const viewer = await harness.newPage(WINDOW);
    const [a, b] = [testScene(), testScene(100)].map((scene) => Buffer.from(encodePly(scene)));
    await viewer.route('**/first.ply', (route) => route.fulfill({ body: a }));
    // In the address of the page, whose parameters are encoded themselves.
    await viewer.route(/second\.ply$/, (route) => route.fulfill({ body: b }));
    await viewer.goto(
      `${harness.server.url}?src=first.ply&src=100%2525%2520second.ply&place=&place=move:0.3:0:0&${CHEAPLY}`,
    );
    await waitForImage(viewer);
    const path = await savePage(viewer, 'zip');
    await viewer.goto(`${await viewer.getByTestId('link').inputValue()}&noui`);
    await waitForImage(viewer);

    const server = await serveFiles(await unpacked(path), { base: '/some/where/' });
    const page = await harness.newPage(WINDOW);
    const sendScene = await holdRequests(page, '**/first.ply');
    await page.goto(`${server.url}index.html`);
    const poster = page.getByTestId('poster');
    await poster.waitFor();
    expect(
      await poster.evaluate((image: HTMLImageElement) => image.decode().then(() => image.naturalWidth)),
    ).toBe(WINDOW.viewport.width);
    sendScene();
    await waitForImage(page);
    const picture = await viewerScreenshot(page);
    expect(colorsIn(picture)).toBeGreaterThan(1000);
    expect(picture).toEqual(await viewerScreenshot(viewer));
    await server.close();
  });
});
