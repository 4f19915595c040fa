// Proves: several files together: placed, linked, saved, hidden, removed.
import { readFile } from 'node:fs/promises';
import { encodePly, readSplats } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { MIN_PSNR_DB, psnrAgainstReference } from './reference.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  CHEAPLY,
  drawnCamera,
  dropFiles,
  loseDeviceOnDemand,
  openSaveTab,
  press,
  redraw,
  showFigures,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForNotice,
  waitForScene,
} from './viewer-page.ts';

const [a, b] = [testScene(200), testScene(60)];
const [A, B] = [encodePly(a), encodePly(b)];
const SETTINGS = new TextEncoder().encode(
  JSON.stringify({
    version: 2,
    background: { color: [1, 0, 0] },
    cameras: [{ initial: { position: [0, 0.5, 3], target: [0, 0, 0], fov: 60 } }],
    animTracks: [],
    startMode: 'default',
  }),
);
const harness = viewerHarness({ 'a.ply': A, 'b.ply': B });
const LARGE = encodePly(testScene(6000));
const SCENE_PAIRS = 10;
const WARM_PAIRS = 4;
/** Less than two of the large files. */
const HEAP_SPREAD_BYTES = 1.5 * LARGE.length;
/** Wide enough for the panel to leave the handles in the middle of the picture. */
const WINDOW = { viewport: { width: 900, height: 260 } };
const BOTH = `?src=a.ply&src=b.ply&${CHEAPLY}`;
/** For pictures that are compared. */
const BOTH_EXACTLY = '?src=a.ply&src=b.ply&accuracy=reference,rasterizer:tiles';
const FILES = [
  { name: 'a.ply', bytes: A },
  { name: 'b.ply', bytes: B },
];

const titles = (page: Page) => page.getByTestId('part-name').locator('span').allTextContents();
const matrices = async (page: Page) => (await drawnCamera(page)).modelMatrices;
const moved = async (page: Page, axis: 'x' | 'y') =>
  Number(await page.getByTestId(`part-move-${axis}`).inputValue());

/** Opens both files in a window that tests share, and the panel in which `b.ply` is chosen. */
async function openBoth(address = BOTH): Promise<Page> {
  const page = await harness.openShared(address, WINDOW);
  await waitForScene(page, 'a.ply and b.ply');
  await page.keyboard.press('n');
  await page.getByTestId('part-name').nth(1).click();
  return page;
}

describe('several files in the viewer', () => {
  it('are shown together but for one that cannot be loaded, which is told and leaves the address', async () => {
    const page = await harness.openShared(`?src=a.ply&src=gone.ply&src=b.ply&${CHEAPLY}`, WINDOW);
    await waitForScene(page, 'a.ply and b.ply', 'error');
    expect(await textOf(page, 'error')).toContain('gone.ply');
    expect(await textOf(page, 'scene-title')).toBe('a.ply and b.ply');
    expect(await textOf(page, 'scene')).toContain('2 files · 260 splats');
    await page.keyboard.press('Escape');
    await page.waitForURL((url) => url.searchParams.getAll('src').join() === 'a.ply,b.ply');
  });

  it('stand where fields of the panel put them, as in float64, and are linked without room for the panel', async () => {
    const page = await openBoth(BOTH_EXACTLY);
    await redraw(page, () => page.getByTestId('part-move-x').fill('1.5'));
    await redraw(page, () => page.getByTestId('part-turn-y').fill('90'));
    await redraw(page, () => page.getByTestId('part-scale').fill('0.5'));
    await page.getByTestId('part-opacity').focus();
    await redraw(page, () => page.keyboard.press('PageDown'));
    const placed = await drawnCamera(page);
    expect(placed.opacities).toEqual([1, 0.9]);
    const shot = await viewerScreenshot(page);
    expect(psnrAgainstReference(shot, placed, [a, b])).toBeGreaterThan(MIN_PSNR_DB);

    await page.waitForURL((url) => /^move:1\.5:0:0,.*opacity:0\.9/.test(url.searchParams.getAll('place')[1]));
    const link = new URL(page.url()).search;
    await redraw(page, () => page.getByTestId('viewport').press('n'));
    const drawn = await drawnCamera(page);
    expect(drawn.viewMatrix).toEqual(placed.viewMatrix);
    expect(drawn.projectionMatrix).not.toEqual(placed.projectionMatrix);
    const other = await harness.openShared(`${link}&noui`, WINDOW);
    await waitForScene(other, 'a.ply and b.ply');
    expect(await drawnCamera(other)).toEqual(drawn);
  });

  it('are moved by handles in the picture, by key and by pointer', async () => {
    // No axis is seen end on.
    const page = await openBoth(`${BOTH}&camera=0,-2.6,0,6,0.35,1.25,flipped:1`);
    await page.getByTestId('gizmo-x').focus();
    await redraw(page, () => page.keyboard.press('Shift+ArrowRight'));
    const byKey = await moved(page, 'x');
    expect(byKey).toBeGreaterThan(0);
    const handle = (await page.getByTestId('gizmo-y').locator('span').boundingBox())!;
    const [x, y] = [handle.x + handle.width / 2, handle.y + handle.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await redraw(page, () => page.mouse.move(x, y + 40));
    await page.mouse.up();
    expect(await moved(page, 'x')).toBe(byKey);
    expect(await moved(page, 'y')).toBeGreaterThan(0);
    const followed = (await page.getByTestId('gizmo-y').locator('span').boundingBox())!;
    // But for perspective, which shows the axis shorter or longer elsewhere.
    expect(Math.abs(followed.y - handle.y - 40)).toBeLessThan(6);
  });

  it('lose splats that are selected in both, stand where they were even if the GPU is lost then, and are saved as one file', async () => {
    const page = await harness.newPage(WINDOW);
    await page.addInitScript(loseDeviceOnDemand);
    await page.goto(`${harness.server.url}${BOTH}&place=&place=move:1.5:0:0,scale:0.5`);
    await waitForScene(page, 'a.ply and b.ply');
    await redraw(page, () => page.keyboard.press('i'));
    await page.getByTestId('inspect-tab-select').click();
    await redraw(page, () => page.getByTestId('select-all').click());
    await page.getByTestId('select-count').getByText('260 of 260 splats are selected').waitFor();
    await page.mouse.move(300, 10);
    await page.mouse.down();
    await page.mouse.move(420, 250);
    await redraw(page, () => page.mouse.up());
    const selectedNow = async () => Number((await textOf(page, 'select-count')).match(/^\d+/)?.[0]);
    await expect.poll(selectedNow).toBeLessThan(260);
    const selected = await selectedNow();
    expect(selected).toBeGreaterThan(0);
    await redraw(page, () => page.getByTestId('select-remove').click());

    const before = await matrices(page);
    expect(before[1]).not.toBeNull();
    await page.evaluate(() => dispatchEvent(new Event('lose-device')));
    await waitForNotice(page, 'GPU was lost');
    await waitForScene(page, 'a.ply and b.ply');
    expect(await matrices(page)).toEqual(before);

    await openSaveTab(page, 'file');
    await page.getByTestId('save-edited').getByText('Removed splats are not saved').waitFor();
    const downloading = page.waitForEvent('download');
    await page.getByTestId('save-file').click();
    const download = await downloading;
    expect(download.suggestedFilename()).toBe('a-and-b.ply');
    expect((await readSplats(await readFile(await download.path()))).count).toBe(260 - selected);
  });

  it('are added by Shift, or in the right part of the window, take the place of what is shown elsewhere, and are set by SuperSplat’s settings', async () => {
    const page = await harness.shareViewer(CHEAP, WINDOW);
    await page.keyboard.press('n');
    await dropFiles(page, FILES, undefined, { shiftKey: true });
    await waitForScene(page, 'Still life, small, a.ply, and b.ply');
    expect(await titles(page)).toEqual(['Still life, small', 'a.ply', 'b.ply']);
    const isAimed = async () => {
      expect(await page.getByTestId('drop-add').getAttribute('data-aimed')).toBe('true');
    };
    const inRightPart = { clientX: 850, clientY: 100 };
    await dropFiles(page, FILES.slice(0, 1), isAimed, inRightPart);
    await waitForScene(page, 'Still life, small, a.ply, and 2 more');
    expect(await titles(page)).toEqual(['Still life, small', 'a.ply', 'b.ply', 'a.ply']);
    await dropFiles(page, FILES);
    await waitForScene(page, 'a.ply and b.ply');
    expect(await titles(page)).toEqual(['a.ply', 'b.ply']);

    const { viewMatrix } = await drawnCamera(page);
    await redraw(page, () => dropFiles(page, [{ name: 'settings.json', bytes: SETTINGS }]));
    const { background, ...asSet } = await drawnCamera(page);
    expect(background).toEqual([1, 0, 0]);
    expect(asSet.viewMatrix).not.toEqual(viewMatrix);
  });

  it('are hidden and removed one by one, but for the last', async () => {
    const page = await harness.openShared(`${BOTH}&src=b.ply`, WINDOW);
    await waitForScene(page, 'a.ply, b.ply, and b.ply');
    await page.keyboard.press('n');
    await redraw(page, () => page.getByTestId('part-visible').first().click());
    expect(await matrices(page)).toHaveLength(2);
    // Without one that is hidden, the picture is the same.
    await page.getByTestId('part-remove').first().click();
    await expect.poll(() => titles(page)).toEqual(['b.ply', 'b.ply']);
    await redraw(page, () => page.getByTestId('part-remove').first().click());
    expect(await matrices(page)).toHaveLength(1);
    expect(await page.getByTestId('part-remove').count()).toBe(0);
    // They come back in their places, the first one hidden as before.
    await page.keyboard.press('Control+z');
    await expect.poll(() => titles(page)).toEqual(['b.ply', 'b.ply']);
    await page.keyboard.press('Control+z');
    await expect.poll(() => titles(page)).toEqual(['a.ply', 'b.ply', 'b.ply']);
    await page.locator('[data-testid=part][data-hidden]').waitFor();
    await page.keyboard.press('Control+Shift+Z');
    await expect.poll(() => titles(page)).toEqual(['b.ply', 'b.ply']);
  });

  it('leave no memory behind them, one after another', async () => {
    const page = await harness.shareViewer(CHEAP, { viewport: { width: 480, height: 320 } });
    // Twice: the buttons that save figures are the last.
    await showFigures(page);
    await showFigures(page);
    const gpuBytes = async (): Promise<number> => {
      const saved = page.waitForEvent('download');
      await press(page, 'hud-download-json');
      return JSON.parse(await readFile(await (await saved).path(), 'utf8')).memory.totalBytes;
    };
    const session = await page.context().newCDPSession(page);
    const heapBytes = async () => {
      await session.send('HeapProfiler.collectGarbage');
      return (await session.send('Runtime.getHeapUsage')).usedSize;
    };
    const show = async (name: string, bytes: Uint8Array) => {
      await dropFiles(page, [{ name, bytes }]);
      await waitForScene(page, name);
    };
    const showTwo = async (i: number) => {
      await show(`${i}, small.ply`, B);
      await show(`${i}, large.ply`, LARGE);
      return { heap: await heapBytes(), gpu: await gpuBytes() };
    };
    // Code that is fetched, and the machine code that V8 compiles of it, are there after the first few.
    for (let i = 0; i < WARM_PAIRS; i++) await showTwo(i);
    const before = await showTwo(WARM_PAIRS);
    for (let i = WARM_PAIRS + 1; i < SCENE_PAIRS; i++) await showTwo(i);
    const after = await showTwo(SCENE_PAIRS);
    expect(after.gpu).toBeGreaterThan(1e6);
    expect(after.gpu).toBe(before.gpu);
    expect(after.heap).toBeLessThan(before.heap + HEAP_SPREAD_BYTES);
  });
});
