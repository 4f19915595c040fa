import { readFile } from 'node:fs/promises';
import { encodePly, readSplats } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { MIN_PSNR_DB, psnrAgainstReference } from './reference.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  drawnCamera,
  dropFiles,
  loseDeviceOnDemand,
  redraw,
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
/** A size at which the float64 reference is quick, with a rasteriser that does not follow from times. */
/** Wide enough for the panel to leave the handles in the middle of the picture. */
const WINDOW = { viewport: { width: 900, height: 260 } };
const ADDRESS = '?src=a.ply&src=gone.ply&src=b.ply&accuracy=reference,rasterizer:tiles';

const titles = (page: Page) => page.getByTestId('part-name').locator('span').allTextContents();
const matrices = async (page: Page) => (await drawnCamera(page)).modelMatrices;
const movedAlongX = async (page: Page) => Number(await page.getByTestId('part-move-x').inputValue());

describe('several files in the viewer', () => {
  it('are shown together, stand where they are put, and are linked, saved and opened again so', async () => {
    const page = await harness.newPage(WINDOW);
    await page.addInitScript(loseDeviceOnDemand);
    await page.goto(harness.server.url + ADDRESS);
    // One that fails leaves the others.
    await waitForScene(page, 'a.ply and b.ply', 'error');
    expect(await textOf(page, 'error-message')).toContain('gone.ply');
    expect(await textOf(page, 'scene-title')).toBe('a.ply and b.ply');
    expect(await textOf(page, 'scene')).toContain('2 clouds · 260 splats');
    await page.keyboard.press('Escape');
    await page.waitForURL((url) => url.searchParams.getAll('src').join() === 'a.ply,b.ply');

    await page.keyboard.press('n');
    await page.getByTestId('part-name').nth(1).click();
    await redraw(page, () => page.getByTestId('part-move-x').fill('1.5'));
    await redraw(page, () => page.getByTestId('part-turn-y').fill('90'));
    await redraw(page, () => page.getByTestId('part-scale').fill('0.5'));
    await page.getByTestId('part-opacity').focus();
    await redraw(page, () => page.keyboard.press('PageDown'));
    const placed = await drawnCamera(page);
    expect(placed.opacities).toEqual([1, 0.9]);
    const shot = await viewerScreenshot(page);
    expect(psnrAgainstReference(shot, placed, [a, b])).toBeGreaterThan(MIN_PSNR_DB);

    // The handles in the picture, by key and by pointer.
    await page.getByTestId('gizmo-x').focus();
    await redraw(page, () => page.keyboard.press('Shift+ArrowRight'));
    const byKey = await movedAlongX(page);
    expect(byKey).toBeGreaterThan(1.5);
    const handle = (await page.getByTestId('gizmo-y').locator('span').boundingBox())!;
    const [x, y] = [handle.x + handle.width / 2, handle.y + handle.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await redraw(page, () => page.mouse.move(x, y + 40));
    await page.mouse.up();
    expect(await movedAlongX(page)).toBe(byKey);
    const moveY = Number(await page.getByTestId('part-move-y').inputValue());
    expect(moveY).toBeGreaterThan(0);
    const followed = (await page.getByTestId('gizmo-y').locator('span').boundingBox())!;
    // But for perspective, which shows the axis shorter or longer elsewhere.
    expect(Math.abs(followed.y - handle.y - 40)).toBeLessThan(6);

    // The address tells all of that.
    const move = `move:${byKey}:${moveY}:0,`;
    await page.waitForURL((url) => url.searchParams.getAll('place').at(1)?.startsWith(move) === true);
    const beside = await drawnCamera(page);
    const link = page.url();
    // The panel, for which the picture has made room, is no part of it.
    await redraw(page, () => page.keyboard.press('n'));
    const drawn = await drawnCamera(page);
    expect(drawn.viewMatrix).toEqual(beside.viewMatrix);
    expect(drawn.projectionMatrix).not.toEqual(beside.projectionMatrix);
    const other = await harness.newPage(WINDOW);
    await other.goto(`${link}&noui`);
    await waitForScene(other, 'a.ply and b.ply');
    expect(await drawnCamera(other)).toEqual(drawn);

    // Splats of both files are selected; those that are removed stay so, whatever happens to the GPU.
    await page.keyboard.press('i');
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

    await page.evaluate(() => dispatchEvent(new Event('lose-device')));
    await waitForNotice(page, 'GPU was lost');
    await waitForScene(page, 'a.ply and b.ply');
    expect(await matrices(page)).toEqual(drawn.modelMatrices);

    await page.keyboard.press('x');
    await page.getByTestId('save-edited').getByText('Removed splats are not saved').waitFor();
    const downloading = page.waitForEvent('download');
    await page.getByTestId('save-file').click();
    const download = await downloading;
    expect(download.suggestedFilename()).toBe('a and b.ply');
    expect((await readSplats(await readFile(await download.path()))).count).toBe(260 - selected);
  });

  it('can be added, hidden and removed', async () => {
    const page = await harness.openViewer(CHEAP, WINDOW);
    // Settings of SuperSplat's alone are for what is shown.
    const { viewMatrix } = await drawnCamera(page);
    await redraw(page, () => dropFiles(page, [{ name: 'settings.json', bytes: SETTINGS }]));
    const { background, ...asSet } = await drawnCamera(page);
    expect(background).toEqual([1, 0, 0]);
    expect(asSet.viewMatrix).not.toEqual(viewMatrix);
    await page.keyboard.press('n');
    const files = [
      { name: 'a.ply', bytes: A },
      { name: 'b.ply', bytes: B },
    ];
    await dropFiles(page, files, undefined, 'viewport', { shiftKey: true });
    await waitForScene(page, 'Still life, small, a.ply, and b.ply');
    expect(await titles(page)).toEqual(['Still life, small', 'a.ply', 'b.ply']);
    // In the right part of the window there is a place to add.
    const inRightPart = { clientX: 850, clientY: 100 };
    await dropFiles(
      page,
      files.slice(0, 1),
      async () => {
        expect(await page.getByTestId('drop-add').getAttribute('data-aimed')).toBe('true');
      },
      'viewport',
      inRightPart,
    );
    await waitForScene(page, 'Still life, small, a.ply, and 2 more');
    expect(await titles(page)).toHaveLength(4);

    await redraw(page, () => page.getByTestId('part-visible').first().click());
    expect(await matrices(page)).toHaveLength(3);
    // Nothing is seen of a hidden one.
    await page.getByTestId('part-remove').first().click();
    await expect.poll(() => titles(page)).toHaveLength(3);
    for (const left of [2, 1]) {
      await redraw(page, () => page.getByTestId('part-remove').first().click());
      expect(await matrices(page)).toHaveLength(left);
    }
    expect(await page.getByTestId('part-remove').count()).toBe(0);
    await dropFiles(page, files);
    await waitForScene(page, 'a.ply and b.ply');
    expect(await titles(page)).toEqual(['a.ply', 'b.ply']);
  });
});
