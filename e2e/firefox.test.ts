// The main paths of the viewer and of React, and hard cases, in Firefox: one browser, a page each.

import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { encodePly } from '@websplatter/core';
import { HARD_CASES, type HardCaseReport, textReport } from '@websplatter/hardcases';
import type { Browser, Page } from '@websplatter/tools/firefox';
import { LONG_PATIENCE_MS } from '@websplatter/tools/patience';
import { afterAll, afterEach, beforeAll, expect } from 'vitest';
import { adoptStyle, type FirefoxPage, launch, openPage, screenshotOf } from './firefox-page.ts';
import type { CanvasDescription } from './react/main.tsx';
import { MIN_PSNR_DB, psnrAgainstReference } from './reference.ts';
import { changedPart, colorsIn } from './screenshot.ts';
import { firefox, lavapipe, puppeteer, testWith } from './second-webgpu.ts';
import { type AppServer, startAppServer } from './server.ts';
import { testScene } from './test-scene.ts';
import {
  type DrawnCamera,
  IMAGE_ALONE,
  isAtRestAfter,
  loseDeviceOnDemand,
  noteNotices,
} from './viewer-page.ts';

const firefoxTest = testWith({
  Firefox: firefox,
  'lavapipe (mesa-vulkan-drivers)': lavapipe,
  'puppeteer-core': puppeteer,
});

const scene = testScene();
/** Enough rows for the GPU to take them. */
const other = testScene(70_000);
/** More than a sample has. */
const large = testScene(240_000);
const servers: AppServer[] = [];
const PATIENTLY = { timeout: LONG_PATIENCE_MS };
let browser: Browser | undefined;
let folder: string;
let watched: FirefoxPage[] = [];
beforeAll(async () => {
  folder = await mkdtemp(join(tmpdir(), 'websplatter-firefox-'));
  if (firefox && lavapipe && puppeteer) browser = await launch();
});
afterEach(async () => {
  const pages = watched;
  watched = [];
  for (const { page } of pages) await page.close();
  expect(
    pages.flatMap(({ problems }) => problems),
    'what the page complained about',
  ).toEqual([]);
});
afterAll(async () => {
  await browser?.close();
  for (const server of servers) await server.close();
  await rm(folder, { recursive: true, force: true });
});

/** Serves an app, with a file `scene.ply` and others, and opens its page. */
async function open(
  appFolder: string,
  address = '',
  files: Readonly<Record<string, Uint8Array>> = {},
): Promise<Page> {
  const server = await startAppServer(appFolder, { 'scene.ply': encodePly(scene), ...files });
  servers.push(server);
  const opened = await openPage(browser!, `${server.url}${address}`, [loseDeviceOnDemand, noteNotices]);
  watched.push(opened);
  return opened.page;
}

const frameCount = (page: Page) =>
  page.evaluate(() => Number(document.querySelector('canvas')?.dataset.frames ?? 0));

/** Waits until the picture at rest shows the scene with this title, and nothing is being loaded. */
async function waitForScene(page: Page, title: string): Promise<void> {
  // `waitForSelector` observes mutations, and has missed this one where much memory had been freed.
  await page.waitForFunction(
    (selector) => document.querySelector(selector) !== null,
    {},
    `html[data-state=ready] canvas[data-resting][data-scene=${JSON.stringify(title)}]`,
  );
}

/** Changes the viewer's picture in one step, and waits until the new one is at rest. */
async function redraw(page: Page, act: () => Promise<unknown>): Promise<void> {
  await page.waitForFunction(isAtRestAfter, {}, 0);
  const frames = await frameCount(page);
  await act();
  await page.waitForFunction(isAtRestAfter, {}, frames);
}

async function expectViewerAsReference(page: Page, set: typeof scene): Promise<DrawnCamera> {
  const drawn: DrawnCamera = await page.evaluate(() =>
    JSON.parse(document.querySelector('canvas')?.dataset.camera ?? 'null'),
  );
  const shot = await screenshotOf(page, '[data-testid=viewport]');
  expect(psnrAgainstReference(shot, drawn, [set])).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  return drawn;
}

/** The viewer with the scene in it, without panels or figures before the picture. */
async function openViewer(options = '', files?: Readonly<Record<string, Uint8Array>>): Promise<Page> {
  const page = await open('apps/viewer', `?file=/scene.ply${options}`, files);
  await waitForScene(page, 'scene.ply');
  await adoptStyle(page, IMAGE_ALONE);
  return page;
}

firefoxTest('the viewer opens a scene, moves about it and is resized', async () => {
  const page = await openViewer();
  const before = await expectViewerAsReference(page, scene);
  await redraw(page, () => page.keyboard.press('ArrowRight'));
  await redraw(page, async () => {
    await page.mouse.move(100, 80);
    await page.mouse.down();
    await page.mouse.move(130, 75);
    await page.mouse.up();
  });
  const moved = await expectViewerAsReference(page, scene);
  expect(moved.viewMatrix).not.toEqual(before.viewMatrix);

  await redraw(page, () => page.setViewport({ width: 160, height: 200 }));
  const resized = await expectViewerAsReference(page, scene);
  expect(resized.projectionMatrix[5] / resized.projectionMatrix[0]).toBeCloseTo(160 / 200);
});

/** For the page: has the file that it saves next kept, in place of a download. */
function keepSaved(): Promise<void> {
  const { createObjectURL } = URL;
  HTMLAnchorElement.prototype.click = () => {};
  return new Promise((resolve) => {
    URL.createObjectURL = (blob: Blob) => {
      void blob.text().then((text) => {
        Object.assign(window, { saved: text });
        resolve();
      });
      return createObjectURL(blob);
    };
  });
}

firefoxTest('a scene that is saved as a web page shows the picture of `?noui` from a disk', async () => {
  const view = 'camera=0,0,0,4,0.5,1.2&accuracy=fast,rasterizer:tiles';
  const served = await open('apps/viewer', `?file=/scene.ply&${view}`);
  await waitForScene(served, 'scene.ply');
  await served.keyboard.press('x');
  await served.waitForSelector('[data-testid=save-html]');
  const saved = served.evaluate(keepSaved);
  await served.evaluate(() => document.querySelector<HTMLElement>('[data-testid=save-html]')?.click());
  await saved;
  const text = await served.evaluate(() => (window as unknown as { saved: string }).saved);
  const path = join(folder, 'scene.html');
  await writeFile(path, text);

  await served.goto(`${servers.at(-1)!.url}?file=/scene.ply&noui&${view}`);
  await waitForScene(served, 'scene.ply');
  const opened = await openPage(browser!, pathToFileURL(path).href);
  watched.push(opened);
  await waitForScene(opened.page, 'scene.ply');
  const shot = await screenshotOf(opened.page, '[data-testid=viewport]');
  expect(colorsIn(shot)).toBeGreaterThan(1000);
  expect(shot).toEqual(await screenshotOf(served, '[data-testid=viewport]'));
});

firefoxTest('the viewer opens panels, and shows the link where there is no clipboard', async () => {
  const page = await openViewer();
  await page.keyboard.press('e');
  await page.waitForSelector('[data-testid=effect-harmonics]');
  await page.keyboard.press('l');
  await page.waitForFunction(() =>
    (window as unknown as { notices: string[] }).notices.some((notice) => /[Tt]he link/.test(notice)),
  );
});

firefoxTest('the viewer takes a file, and reads it again for another device', async () => {
  const page = await openViewer();
  const path = join(folder, 'other.ply');
  await writeFile(path, encodePly(other));
  const input = await (await page.$('[data-testid=file-input]'))!.toElement('input');
  await input.uploadFile(path);
  await waitForScene(page, 'other.ply');
  await expectViewerAsReference(page, other);

  await redraw(page, () => page.evaluate(() => void dispatchEvent(new Event('lose-device'))));
  await expectViewerAsReference(page, other);
});

firefoxTest('the viewer shows another mode, and explains a splat', async () => {
  const page = await openViewer();
  await redraw(page, () => page.setViewport({ width: 320, height: 320 }));
  await redraw(page, () => page.keyboard.press('m'));
  await page.waitForSelector('[data-testid=mode-legend]');
  await redraw(page, () => page.keyboard.press('i'));
  await page.waitForSelector('[data-testid=inspect]');
  // The middle of the area beside the panel, where the scene goes.
  const [x, y] = await page.$eval('.free-area', (area) => {
    const { x, y, width, height } = area.getBoundingClientRect();
    return [x + width / 2, y + height / 2];
  });
  await page.mouse.click(x, y);
  await page.waitForSelector('[data-testid=inspect-position]');
});

firefoxTest('the viewer takes files that are dropped together', async () => {
  const page = await openViewer();
  await dropFiles(page, ['a.ply', 'b.ply'], 'scene.ply');
  await waitForScene(page, 'a.ply and b.ply');
});

/** Drops files of these names on the picture, each with what the server has at `address`. */
async function dropFiles(page: Page, names: readonly string[], address: string): Promise<void> {
  const drop = async (list: readonly string[], from: string) => {
    const dataTransfer = new DataTransfer();
    const bytes = await (await fetch(from)).arrayBuffer();
    for (const name of list) dataTransfer.items.add(new File([bytes], name, { lastModified: 1e12 }));
    const target = document.querySelector('[data-testid=viewport]');
    for (const type of ['dragenter', 'dragover', 'drop'])
      target?.dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
  };
  await page.evaluate(drop, names, address);
}

firefoxTest(
  'the viewer keeps a large file in its storage, streams it from there, and has it at once then',
  async () => {
    const page = await openViewer('&keep=1000000&accuracy=fast', { 'large.ply': encodePly(large) });
    const kept = () =>
      page.evaluate(async () => {
        const root = await navigator.storage.getDirectory();
        const names: string[] = [];
        for await (const scene of (await root.getDirectoryHandle('websplatter-bricks')).values())
          for await (const name of (scene as FileSystemDirectoryHandle).keys()) names.push(name);
        return names.sort();
      });
    const drop = async () => {
      await page.evaluate(() => {
        Object.assign(window, { phases: new Set<string>() });
        const { phases } = window as unknown as { phases: Set<string> };
        new MutationObserver(() => {
          phases.add(document.querySelector('[data-testid=load-phase]')?.textContent ?? '');
        }).observe(document, { childList: true, characterData: true, subtree: true });
      });
      await dropFiles(page, ['large.ply'], 'large.ply');
    };
    const wasArranged = () =>
      page.evaluate(() =>
        (window as unknown as { phases: Set<string> }).phases.has('Arranging for streaming'),
      );
    const address = page.url();
    await drop();
    await waitForScene(page, 'large.ply');
    expect(await wasArranged()).toBe(true);
    expect(await kept()).toEqual(['about.json', 'scene.bricks', 'used']);
    await expectViewerAsReference(page, large);

    await page.goto(address);
    await waitForScene(page, 'scene.ply');
    await adoptStyle(page, IMAGE_ALONE);
    await drop();
    await waitForScene(page, 'large.ply');
    expect(await wasArranged()).toBe(false);
    await expectViewerAsReference(page, large);
  },
);

firefoxTest('React draws, changes and leaves nothing behind', async () => {
  const page = await open('e2e/react');
  await page.waitForFunction(() => 'page' in window);
  const showAll = (canvases: CanvasDescription[]) =>
    page.evaluate((list) => window.page.show(list), canvases);
  const show = (splats: CanvasDescription['splats']) =>
    showAll([{ id: 'canvas', kind: 'splats', background: 'black', splats }]);
  const held = () => page.evaluate(() => window.page.countResources());
  const waitForLog = (entry: string) =>
    page.waitForFunction((text) => window.page.log.includes(text), {}, entry);
  const bytes = () => page.evaluate(() => window.page.engine('canvas').memory().totalBytes);

  const heldBefore = await held();
  await show([{ id: 'a', src: 'scene.ply' }]);
  await waitForLog('a firstframe');
  const camera = await page.evaluate(() => {
    const { matrixWorldInverse, projectionMatrix, near, far } = window.page.canvases.get('canvas')!.camera;
    const viewMatrix = [...matrixWorldInverse.elements];
    return { viewMatrix, projectionMatrix: [...projectionMatrix.elements], near, far };
  });
  const drawn: DrawnCamera = { ...camera, modelMatrices: [null], background: [0, 0, 0] };
  const shot = () => screenshotOf(page, '[data-testid=canvas]');
  await expect
    .poll(async () => psnrAgainstReference(await shot(), drawn, [scene]), PATIENTLY)
    .toBeGreaterThanOrEqual(MIN_PSNR_DB);
  const image = await shot();

  await show([{ id: 'a', src: 'scene.ply', opacity: 0.3 }]);
  await expect.poll(async () => changedPart(image, await shot()), PATIENTLY).toBeGreaterThan(0.1);

  expect(await bytes()).toBeGreaterThan(0);
  await show([]);
  await expect.poll(bytes, PATIENTLY).toBe(0);
  await showAll([]);
  await expect.poll(held, PATIENTLY).toEqual(heldBefore);
});

/**
 * One with images: Firefox tells every tenth of a second whether the GPU is done, so that a case
 * takes seconds. Deno, whose WebGPU is the same, runs all.
 */
const CASES = ['tiles-splats-in-all'];

firefoxTest('a hard case passes on the page of hard cases, which gives a report', async () => {
  const page = await open('apps/lab', `?conformance&cases=${CASES}`);
  await page.waitForSelector('html[data-state=idle]');
  await page.click('[data-testid=run]');
  await page.waitForSelector('html[data-state=done], html[data-state=failed]', { timeout: LONG_PATIENCE_MS });
  const outcome = await page.$eval('main', ({ textContent }) => textContent);
  const state = await page.evaluate(() => document.documentElement.dataset.state);
  expect(state, outcome ?? '').toBe('done');
  const report = await page.evaluate(() => JSON.parse(JSON.stringify(window.report)) as HardCaseReport);
  const text = textReport(report);
  expect(report.results.flatMap(({ failures }) => failures)).toEqual([]);
  expect(text).toContain(`WebSplatter: 1 of 1 chosen hard cases (${HARD_CASES.length} in all) pass`);
  expect(report.features).not.toContain('float32-blendable');
  expect(text).toMatch(/^program +Mozilla.*Firefox/m);
  expect(text).toMatch(/^adapter +.*software$/m);
  // JSON has no infinities, which are the decibels of images that are equal.
  const withoutDecibels = (shown: string | null) => shown?.replace(/^(quads|tiles), .*$/gm, '');
  const shown = await page.$eval('[data-testid=report-text]', (pre) => pre.textContent);
  const [, ...lines] = text.trimEnd().split('\n');
  expect(withoutDecibels(shown)).toBe(withoutDecibels(lines.join('\n')));
});
