// Proves: a scene saved as one web page, and as a zip for web hosts.
import { mkdir, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { encodePly, readSplats } from '@websplatter/core';
import { serveFiles } from '@websplatter/tools/file-server';
import type { Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { openZipEntry, readZipDirectory } from '../packages/core/src/io/containers/zip.ts';
import { holdRequests } from './browser.ts';
import { colorsIn, psnrOf } from './screenshot.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  CHEAPLY,
  clickInTurn,
  drawnCamera,
  giveToolbarNoRoom,
  openSaveTab,
  press,
  redraw,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForImage,
  waitForNotice,
} from './viewer-page.ts';

const [first, second] = [400, 100].map((count) => encodePly(testScene(count)));
const harness = viewerHarness({
  'first.ply': first,
  'second.ply': second,
  // In the address of the page, whose parameters are encoded themselves.
  '100%25%20second.ply': second,
});
const WINDOW = { viewport: { width: 320, height: 240 } };
const LARGE = { viewport: { width: 900, height: 600 } };
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
async function openFile(path: string, script = () => {}, options = WINDOW): Promise<Page> {
  const page = await harness.newPage(options);
  await page.context().setOffline(true);
  await page.addInitScript(script);
  await page.goto(pathToFileURL(path).href);
  return page;
}

describe('a scene that is saved as one web page', () => {
  it('shows the picture of `?noui` from a disk, bit for bit, and can be moved', async () => {
    const address = `?src=first.ply&src=second.ply&place=&place=move:0.3:0:0,opacity:0.5&${CHEAPLY}`;
    const viewer = await harness.shareViewer(`${address}&effects=brightness:0.2`, WINDOW);
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
    const viewer = await harness.shareViewer(`?scene=still-life-small&${CHEAPLY}&${annotation}`, WINDOW);
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

/** Splats of the only scene in a saved page. */
async function splatsIn(path: string) {
  const [, base64] = /data-path="[^"]*">([^<]*)</.exec(await readFile(path, 'utf8')) ?? [];
  return readSplats(Uint8Array.from(Buffer.from(base64 ?? '', 'base64')));
}

describe('a page of an edited scene', () => {
  it('holds no splat that was cropped away or removed, and shows the same picture', async () => {
    const viewer = await harness.shareViewer(CHEAP, LARGE);
    await giveToolbarNoRoom(viewer);
    await redraw(viewer, () => viewer.keyboard.press('i'));
    await viewer.getByTestId('inspect-tab-crop').click();
    await redraw(viewer, () => viewer.getByTestId('crop-begin').click());
    await redraw(viewer, () => viewer.getByTestId('crop-max-x-number').fill('0'));
    await viewer.getByTestId('inspect-tab-select').click();
    await redraw(viewer, async () => {
      await viewer.mouse.move(150, 150);
      await viewer.mouse.down();
      await viewer.mouse.move(300, 300);
      await viewer.mouse.up();
    });
    await redraw(viewer, () => viewer.getByTestId('select-remove').click());
    await viewer.keyboard.press('Escape');
    // What a file of the scene has is known to leave out all that is cut.
    await openSaveTab(viewer, 'file');
    const [file] = await Promise.all([viewer.waitForEvent('download'), press(viewer, 'save-file')]);
    const saved = await readSplats(new Uint8Array(await readFile(await file.path())));
    expect(saved.count).toBeLessThan(9000);
    await redraw(viewer, () => viewer.keyboard.press('x'));
    const before = await viewerScreenshot(viewer);

    await openSaveTab(viewer, 'share');
    expect(await textOf(viewer, 'page-cut')).toContain('left out');
    expect(await textOf(viewer, 'link-lacks')).toMatch(/without your [\d,]+ removals\. Save a web page/);
    await viewer.keyboard.press('x');
    const path = await savePage(viewer);
    const held = await splatsIn(path);
    expect(held.count).toBe(saved.count);
    const xs = Array.from({ length: held.count }, (_, i) => held.positions[3 * i] + held.origin[0]);
    expect(Math.max(...xs)).toBeLessThanOrEqual(0);

    const page = await openFile(path, undefined, LARGE);
    await waitForImage(page);
    expect(psnrOf(await viewerScreenshot(page), before)).toBeGreaterThan(45);
  });

  it('can be cancelled while it is cut, and says if nothing is left', async () => {
    const crop = (min: number, max: number) => `crop=${[min, min, min, max, max, max].join(':')}:inside`;
    const viewer = await harness.shareViewer(`${CHEAP}&${crop(-0.3, 0.3)}`, LARGE);
    await openSaveTab(viewer, 'share');
    await clickInTurn(viewer, 'save-html', 'cancel-page');
    await waitForNotice(viewer, 'Saving still-life-small.html was cancelled');

    const other = await harness.shareViewer(`${CHEAP}&${crop(500, 501)}`, LARGE);
    await openSaveTab(other, 'share');
    await press(other, 'save-html');
    await expect.poll(() => textOf(other, 'error-message')).toBe('Crop and removals leave no splats.');
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
    const viewer = await harness.shareViewer(
      `?src=first.ply&src=100%2525%2520second.ply&place=&place=move:0.3:0:0&${CHEAPLY}`,
      WINDOW,
    );
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
