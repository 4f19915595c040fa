// Proves: viewer and React in Firefox, and the page of hard cases there.
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { HARD_CASES, type HardCaseReport, textReport } from '@websplatter/conformance';
import { encodePly } from '@websplatter/core';
import type { Page } from '@websplatter/tools/firefox';
import { LONG_PATIENCE_MS } from '@websplatter/tools/patience';
import { expect } from 'vitest';
import { firefoxHarness } from './firefox-harness.ts';
import { adoptStyle, screenshotOf } from './firefox-page.ts';
import { drawnCamera, redraw, waitForScene } from './firefox-viewer.ts';
import type { CanvasDescription } from './react/main.tsx';
import { MIN_PSNR_DB, psnrAgainstReference } from './reference.ts';
import { changedPart } from './screenshot.ts';
import type { ServedFiles } from './server.ts';
import { testScene } from './test-scene.ts';
import { type DrawnCamera, IMAGE_ALONE } from './viewer-page.ts';

const harness = firefoxHarness();
const { firefoxTest } = harness;
const scene = testScene();
/** Enough rows for the GPU to take them. */
const other = testScene(70_000);
/** More than a sample has. */
const large = testScene(205_000);
const PATIENTLY = { timeout: LONG_PATIENCE_MS };

/** Opens an app's page, which has a file `scene.ply` and others. */
const open = (appFolder: string, address = '', files: ServedFiles = {}): Promise<Page> =>
  harness.open(appFolder, address, { 'scene.ply': encodePly(scene), ...files });

async function expectViewerAsReference(page: Page, set: typeof scene): Promise<DrawnCamera> {
  const drawn = await drawnCamera(page);
  const shot = await screenshotOf(page, '[data-testid=viewport]');
  expect(psnrAgainstReference(shot, drawn, [set])).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  return drawn;
}

/** The viewer with the scene in it, without panels or figures before the picture. */
async function openViewer(options = '', files?: ServedFiles): Promise<Page> {
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

firefoxTest('the viewer opens panels, shows the link without a clipboard, and takes two files', async () => {
  const page = await openViewer();
  await page.keyboard.press('e');
  await page.waitForSelector('[data-testid=effect-harmonics]');
  await page.keyboard.press('l');
  await page.waitForFunction(() =>
    (window as unknown as { notices: string[] }).notices.some((notice) => /[Tt]he link/.test(notice)),
  );
  await page.keyboard.press('Escape');
  await dropFiles(page, ['a.ply', 'b.ply'], 'scene.ply');
  await waitForScene(page, 'a.ply and b.ply');
});

/**
 * @fault Other WebGPUs: the device is lost in Firefox
 * @consequence the viewer comes back with scene and view
 */
firefoxTest('the viewer takes a file, and reads it again for another device', async () => {
  const page = await openViewer();
  const path = join(harness.folder, 'other.ply');
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

/**
 * @fault Other WebGPUs: React leaves its page in Firefox
 * @consequence nothing stays in memory
 */
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

/**
 * @fault Other WebGPUs: hard input in Firefox
 * @consequence the image stays within the bounds of a device without optional features
 */
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
