import { encodePly, readSplats } from '@websplatter/core';
import { writeSplats } from '@websplatter/core/write';
import { LONG_PATIENCE_MS } from '@websplatter/tools/patience';
import type { Page } from 'playwright-core';
import { expect, it, vi } from 'vitest';
import { testScene } from './test-scene.ts';
import { CHEAPLY, press, SMALL, textOf, viewerHarness, waitForNotice, waitForScene } from './viewer-page.ts';

// Arranging a large file takes 20 s alone on an idle CPU; two pages do so here.
vi.setConfig({ testTimeout: 3 * LONG_PATIENCE_MS });

/** More than a sample has, in several buckets. */
const ply = encodePly(testScene(205_000));
const READ = { shPrecision: 'f32' } as const;
const { fileFacts: _, ...expected } = await readSplats(
  await writeSplats(await readSplats(ply, READ), 'bricks'),
  READ,
);
const harness = viewerHarness({ 'large.ply': ply });
/** Files above a megabyte are large. */
const ADDRESS = `?scene=still-life-small&keep=1000000&${CHEAPLY}`;
const SMALL_SCENE = 'Still life, small';
/** A part of the work that is done without any bricks; more than half is not. */
const LEAST_GONE_ON = 0.25;

/** Parts of the work that the page has told since the file was dropped. */
declare const toldParts: number[];

/** A page of its own with a small scene. @param initScript runs before the page's own. */
async function openViewer(initScript = () => {}): Promise<Page> {
  const page = await harness.newPage(SMALL);
  page.context().setDefaultTimeout(LONG_PATIENCE_MS);
  await page.addInitScript(initScript);
  await page.goto(`${harness.server.url}${ADDRESS}`);
  await waitForScene(page, SMALL_SCENE);
  return page;
}

const toldTo = (page: Page) => page.evaluate(() => toldParts);
const caption = (page: Page) => page.locator('.caption-figures').innerText();

/** What a page does by itself in the middle of the work: a test could be too late. */
interface Interruption {
  /** Once more of the work than this is done. */
  readonly above: number;
  readonly by: 'cancel' | 'reload';
}

/** Drops the file, which is the same each time, as those from a disk are. */
async function drop(page: Page, interruption: Interruption | null = null): Promise<void> {
  await page.evaluate(async (interrupted) => {
    const parts: number[] = [];
    Object.assign(window, { toldParts: parts });
    new MutationObserver(() => {
      const bar = document.querySelector('[data-testid=load] progress') as HTMLProgressElement | null;
      const phase = document.querySelector('[data-testid=load-phase]')?.textContent;
      if (!bar || phase !== 'Arranging for streaming') return;
      parts.push(bar.value);
      if (!interrupted || bar.value <= interrupted.above) return;
      if (interrupted.by === 'cancel')
        document.querySelector<HTMLElement>('[data-testid=cancel-load]')!.click();
      else {
        sessionStorage.setItem('left at', String(parts[0]));
        location.reload();
      }
    }).observe(document, { childList: true, attributes: true, subtree: true });
    const bytes = await (await fetch('large.ply')).arrayBuffer();
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([bytes], 'large.ply', { lastModified: 1e12 }));
    const canvas = document.querySelector('canvas')!;
    for (const type of ['dragenter', 'dragover', 'drop'])
      canvas.dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
  }, interruption);
}

/** The files that are kept of all scenes, by name. */
function keptFiles(page: Page): Promise<Record<string, Uint8Array<ArrayBuffer>>> {
  return page
    .evaluate(async () => {
      const root = await navigator.storage.getDirectory();
      // Nothing has been kept yet.
      const folders = await root.getDirectoryHandle('websplatter-bricks').catch(() => null);
      const found: Record<string, string> = {};
      if (!folders) return found;
      for await (const folder of folders.values())
        for await (const entry of (folder as FileSystemDirectoryHandle).values()) {
          const file = await (entry as FileSystemFileHandle).getFile();
          const reader = new FileReader();
          reader.readAsDataURL(file);
          await new Promise((resolve) => reader.addEventListener('load', resolve));
          found[entry.name] = String(reader.result).replace(/^.*,/, '');
        }
      return found;
    })
    .then((found) =>
      Object.fromEntries(
        Object.entries(found).map(([name, base64]) => [name, new Uint8Array(Buffer.from(base64, 'base64'))]),
      ),
    );
}

async function expectWholeScene(page: Page): Promise<void> {
  const files = await keptFiles(page);
  expect(Object.keys(files).sort()).toEqual(['about.json', 'scene.bricks', 'used']);
  // Browsers have a zlib of their own, which packs the same bytes otherwise.
  const { fileFacts: _, ...kept } = await readSplats(files['scene.bricks'], READ);
  expect(kept).toEqual(expected);
}

it('shows a sample of a large file at once, then streams all of it, at once the next time', async () => {
  const page = await openViewer();
  await drop(page);
  await page.waitForFunction(() => document.title.startsWith('large.ply'));
  await expect.poll(() => textOf(page, 'load-phase')).toBe('Arranging for streaming');
  expect(await caption(page)).toMatch('200,000');
  // Another window waits for the same work.
  const other = await harness.newTab(page);
  await other.goto(`${harness.server.url}${ADDRESS}`);
  await waitForScene(other, SMALL_SCENE);
  await drop(other);
  for (const each of [page, other]) {
    await waitForScene(each, 'large.ply');
    expect(await caption(each)).toMatch('205,000');
  }
  await expectWholeScene(page);
  expect(await toldTo(other)).toEqual([]);
  const parts = await toldTo(page);
  expect(parts).toEqual(parts.toSorted((a, b) => a - b));
  expect(parts.at(-1)).toBe(1);

  await other.goto(`${harness.server.url}${ADDRESS}`);
  await waitForScene(other, SMALL_SCENE);
  await drop(other);
  await waitForScene(other, 'large.ply');
  expect(await toldTo(other)).toEqual([]);
  await page.close();
  // It is on the screen.
  await other.keyboard.press('n');
  await press(other, 'remove-kept');
  await other.getByText('large.ply is open here or in another window').waitFor();
  await other.goto(`${harness.server.url}${ADDRESS}`);
  await waitForScene(other, SMALL_SCENE);
  await other.keyboard.press('n');
  expect(await textOf(other, 'kept')).toMatch(/^large\.ply4\.\d MB/);
  await press(other, 'remove-kept');
  await other.getByTestId('kept').waitFor({ state: 'detached' });
  expect(await keptFiles(other)).toEqual({});
});

it('goes on with work that was cancelled, or ended with its page, and has helpers', async () => {
  const page = await openViewer(() => {
    Object.defineProperty(Navigator.prototype, 'hardwareConcurrency', { get: () => 4 });
  });
  await drop(page, { above: 0.5, by: 'cancel' });
  await waitForNotice(page, 'Opening large.ply was cancelled.');
  await waitForScene(page, SMALL_SCENE);
  expect(Object.keys(await keptFiles(page))).toContain('journal');
  await page.keyboard.press('n');
  expect(await textOf(page, 'kept')).toMatch(/^large\.ply\d+ MB, not finished/);

  await drop(page, { above: 0, by: 'reload' });
  const leftAt = () => page.evaluate(() => Number(sessionStorage.getItem('left at')));
  await expect.poll(leftAt).toBeGreaterThan(LEAST_GONE_ON);
  await waitForScene(page, SMALL_SCENE);
  const first = await leftAt();
  await drop(page);
  await waitForScene(page, 'large.ply');
  expect((await toldTo(page))[0]).toBeGreaterThanOrEqual(first);
  await expectWholeScene(page);
});

it('says how much room it needs where that lacks, and shows the sample', async () => {
  const page = await openViewer();
  const session = await page.context().newCDPSession(page);
  const origin = new URL(harness.server.url).origin;
  await session.send('Storage.overrideQuotaForOrigin', { origin, quotaSize: 2e7 });
  await drop(page);
  await waitForScene(page, 'large.ply', 'error');
  expect(await textOf(page, 'error')).toMatch('Only some splats of large.ply are shown');
  expect(await textOf(page, 'error-message')).toMatch(
    /needs \d+ MB of this browser's storage, which has \d+ MB left/,
  );
  expect(await caption(page)).toMatch('200,000');
});
