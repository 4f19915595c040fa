// Proves: the viewer on static hosting below a path; files that URLs name.
import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { encodePly } from '@websplatter/core';
import { type FileServer, serveFiles } from '@websplatter/tools/file-server';
import type { Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { builtApp, CONTENT_SECURITY_POLICY } from './server.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  CHEAPLY,
  dropFiles,
  textOf,
  viewerHarness,
  waitForImage,
  waitForScene,
  waitForState,
} from './viewer-page.ts';

const harness = viewerHarness();
let folder = '';
let host: FileServer;

beforeAll(async () => {
  folder = await mkdtemp(join(tmpdir(), 'websplatter-hosting-'));
  const site = await builtApp('apps/viewer');
  const scenes = { 'scenes/a.ply': join(folder, 'a.ply'), 'b.ply': join(folder, 'b.ply') };
  await writeFile(scenes['scenes/a.ply'], encodePly(testScene()));
  await writeFile(scenes['b.ply'], encodePly(testScene(100)));
  host = await serveFiles(site, {
    base: '/some/where/',
    files: { ...scenes, '': join(site, 'index.html'), 'lab/': join(site, 'lab/index.html') },
    headers: { 'content-security-policy': CONTENT_SECURITY_POLICY },
  });
});
afterAll(async () => {
  await host?.close();
  await rm(folder, { recursive: true, force: true });
});

describe('the viewer on plain static hosting, below a path', () => {
  it('draws, and has the licences of the packages in it, to which the help leads', async () => {
    const page = await harness.newPage();
    await page.goto(`${host.url}index.html${CHEAP}`);
    await waitForScene(page, 'Still life, small');
    expect(await textOf(page, 'scene-title')).toContain('Still life');
    await page.keyboard.press('?');
    await page.getByRole('link', { name: 'Licences' }).click();
    await page.getByText('mediabunny').first().waitFor();
    const text = (await page.textContent('body')) ?? '';
    for (const words of ['(MPL-2.0)', 'react-dom', 'zustand', 'THE SOFTWARE IS PROVIDED "AS IS"'])
      expect(text).toContain(words);
  });

  it('has links that lead from the gallery to a case and back', async () => {
    const page = await harness.newPage();
    await page.goto(`${host.url}index.html?scene=hard&q=camera-orthographic&${CHEAPLY}`);
    await page.getByTestId('gallery-case').getByRole('link').first().click();
    await page.getByTestId('case-open').click();
    await waitForScene(page, 'camera-orthographic');
    expect(await textOf(page, 'scene-title')).toBe('camera-orthographic');
    await page.getByRole('link', { name: 'All hard cases' }).click();
    await page.getByTestId('gallery').waitFor();
    await page.getByRole('link', { name: 'Viewer', exact: true }).click();
    await waitForImage(page);
    expect(await textOf(page, 'scene-title')).toContain('Still life');
  });
});

describe('files that the address of the viewer names', () => {
  it('are opened relative to the page and shown together, also one that is named by `url`', async () => {
    const page = await harness.newPage();
    await page.goto(`${host.url}index.html?src=scenes/a.ply&src=b.ply&${CHEAPLY}`);
    await waitForScene(page, 'a.ply and b.ply');
    expect(await textOf(page, 'scene-title')).toBe('a.ply and b.ply');
    expect(await textOf(page, 'scene')).toContain('2 files · 500 splats');
    await page.goto(`${host.url}index.html?url=b.ply&${CHEAPLY}`);
    await waitForScene(page, 'b.ply');
    expect(await textOf(page, 'scene')).toContain('100 splats');
  });

  it('leave the scene beside an error where they are missing, or no address', async () => {
    const page = await harness.newPage();
    await page.goto(`${host.url}index.html${CHEAP}&src=missing.ply`);
    await waitForScene(page, 'Still life, small', 'error');
    expect(await textOf(page, 'error-message')).toContain('missing.ply');
    expect(await textOf(page, 'scene-title')).toContain('Still life');

    await page.goto(`${host.url}index.html${CHEAP}&src=http://[`);
    await waitForScene(page, 'Still life, small', 'error');
    expect(await textOf(page, 'error')).toContain('“http://[” is not an address.');

    // But the picture alone is that of the page, or none.
    for (const missing of ['missing.ply', 'http://[']) {
      await page.goto(`${host.url}index.html${CHEAP}&noui&src=${missing}`);
      await waitForState(page, 'error');
      expect(await page.title()).toBe('WebSplatter');
      expect(await page.getByTestId('thin-progress').count()).toBe(0);
    }
  });
});

/** For `addInitScript`: a picker of the origin's own files, which need no permission. */
function pickFromOwnFiles(): void {
  Object.assign(window, {
    showOpenFilePicker: async () => {
      const folder = await navigator.storage.getDirectory();
      return [await folder.getFileHandle('mine.ply')];
    },
  });
}

/** Waits until the viewer has kept the file `name`, or none: earlier reloads do not find it. */
async function waitForKept(page: Page, name: string | null): Promise<void> {
  // `waitForFunction` takes the promise of an asynchronous function for its answer.
  await expect.poll(() => page.evaluate(keptName)).toBe(name);
}

/** For `evaluate`: name of the file that the viewer has kept, or null. */
async function keptName(): Promise<string | null> {
  const ask = <T>(request: IDBRequest<T>) =>
    new Promise<T>((resolve, reject) => {
      request.onsuccess = () => resolve(request.result);
      request.onerror = () => reject(request.error);
    });
  // To open one that is not there would make it.
  const databases = await indexedDB.databases();
  if (!databases.some((each) => each.name === 'websplatter')) return null;
  const database = await ask(indexedDB.open('websplatter'));
  const kept = await ask(database.transaction('files').objectStore('files').get('last'));
  database.close();
  return kept?.name ?? null;
}

/** Opens the viewer with a picker that gives `mine.ply`, 50 splats; the next scene is kept. */
async function openKeeping(): Promise<Page> {
  const page = await harness.newPage();
  await page.addInitScript(pickFromOwnFiles);
  await page.goto(`${host.url}index.html${CHEAP}`);
  await waitForImage(page);
  await page.evaluate(
    async (bytes) => {
      const folder = await navigator.storage.getDirectory();
      const writable = await (await folder.getFileHandle('mine.ply', { create: true })).createWritable();
      await writable.write(Uint8Array.from(bytes));
      await writable.close();
    },
    Array.from(encodePly(testScene(50))),
  );
  return page;
}

async function expectMine(page: Page): Promise<void> {
  await waitForScene(page, 'mine.ply');
  expect(await textOf(page, 'scene')).toContain('50 splats');
  await waitForKept(page, 'mine.ply');
}

/** Drops `dropped.ply` and reloads the page, which offers it. Scripted drops have no handles. */
async function reloadAfterDrop(page: Page): Promise<void> {
  await dropFiles(page, [{ name: 'dropped.ply', bytes: encodePly(testScene()) }]);
  await waitForScene(page, 'dropped.ply');
  await waitForKept(page, 'dropped.ply');
  await page.reload();
  await page.getByTestId('reopen').getByText('dropped.ply').waitFor();
}

describe('the file that was open', () => {
  it('is offered after a reload, and read by its handle', async () => {
    const page = await openKeeping();
    expect(await page.getByTestId('reopen').count()).toBe(0);
    await page.getByTestId('command-open').click();
    await page.getByTestId('choose-files').click();
    await expectMine(page);
    await page.reload();
    await page.getByTestId('reopen').getByText('mine.ply was open before').waitFor();
    await page.getByTestId('reopen-file').click();
    await expectMine(page);
    expect(await page.getByTestId('reopen').count()).toBe(0);
  });

  it('is to be chosen again where it has no handle, but not in a page with a scene of its own', async () => {
    const page = await openKeeping();
    await reloadAfterDrop(page);
    await page.goto(`${host.url}index.html?src=b.ply&${CHEAPLY}`);
    await waitForImage(page);
    expect(await page.getByTestId('reopen').count()).toBe(0);
    await page.goto(`${host.url}index.html${CHEAP}`);
    await page.getByTestId('reopen').getByText('dropped.ply').waitFor();
    expect(await textOf(page, 'reopen-file')).toBe('Choose it again');
    await page.getByTestId('reopen-file').click();
    await expectMine(page);
  });

  it('is forgotten where that is asked for', async () => {
    const page = await openKeeping();
    await reloadAfterDrop(page);
    await page.getByTestId('forget-file').click();
    await waitForKept(page, null);
    await page.reload();
    await waitForImage(page);
    expect(await page.getByTestId('reopen').count()).toBe(0);
  });
});
