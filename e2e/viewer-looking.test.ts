// Proves: focus, zoom to the cursor, projection, flying, kept views.
import { readFile } from 'node:fs/promises';
import { encodePly, readSplats } from '@websplatter/core';
import { transformSplats } from '@websplatter/core/write';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import {
  CHEAP,
  type DrawnCamera,
  drawnCamera,
  dropFiles,
  redraw,
  textOf,
  viewerHarness,
  waitForScene,
} from './viewer-page.ts';

const { shareViewer } = viewerHarness();

/** Does something that changes the image, and returns the camera of the image that follows. */
async function after(page: Page, act: () => Promise<unknown>): Promise<DrawnCamera> {
  await redraw(page, act);
  return drawnCamera(page);
}

/** The camera's position in the world. */
function positionOf({ viewMatrix: v }: DrawnCamera): number[] {
  return [0, 1, 2].map((axis) => -(v[4 * axis] * v[12] + v[4 * axis + 1] * v[13] + v[4 * axis + 2] * v[14]));
}

/** The columns of the camera's rotation. */
const rotationOf = ({ viewMatrix }: DrawnCamera) => [0, 4, 8].flatMap((at) => viewMatrix.slice(at, at + 3));

/** Expects the same but for rounding. */
function expectClose(actual: readonly number[], expected: readonly number[]): void {
  const errors = actual.map((value, i) => Math.abs(value - expected[i]));
  expect(Math.max(...errors), `[${actual}] against [${expected}]`).toBeLessThan(1e-9);
}

/** The part of the picture that panels leave free, and the place there of the camera's target. */
async function freeArea(page: Page, { projectionMatrix: p }: DrawnCamera) {
  const free = await page.locator('.free-area').evaluate((e) => e.getBoundingClientRect().toJSON());
  const { width, height } = page.viewportSize()!;
  const middle = [((1 - p[8]) * width) / 2, ((1 + p[9]) * height) / 2];
  // Tangents of half the angles of view over its sides.
  const tangents = [free.width / width / p[0], free.height / height / p[5]];
  return { middle, freeMiddle: [free.width / 2, free.height / 2], tangent: Math.min(...tangents) };
}

describe('looking around in the viewer', () => {
  it('begins with a capture upright and within its sky, looks at it from outside and inside, and turns it', async () => {
    const page = await shareViewer(CHEAP, { viewport: { width: 480, height: 320 } });
    // y is up in it, as in no convention of its format, and its sky is a dome.
    const file = new URL('../packages/scenes/files/still-life-small.spz', import.meta.url);
    await dropFiles(page, [{ name: 'capture.spz', bytes: await readFile(file) }]);
    await waitForScene(page, 'capture.spz');
    const first = await drawnCamera(page);
    expect(first.modelMatrices).toEqual([null]);
    const [, above] = [0, 1].map((row) => [0, 4, 8].map((at) => first.viewMatrix[at + row]));
    expect(above[1]).toBeGreaterThan(0.8);
    expect(Math.hypot(...positionOf(first))).toBeLessThan(4);
    await after(page, () => page.keyboard.press('ArrowRight'));
    await after(page, () => page.keyboard.press('-'));
    // As near, from another side.
    const framed = await after(page, () => page.keyboard.press('f'));
    expect(framed.viewMatrix[14]).toBeCloseTo(first.viewMatrix[14], 1);
    const home = await after(page, () => page.keyboard.press('r'));
    expectClose(home.viewMatrix, first.viewMatrix);
    const outside = await after(page, () => page.keyboard.press('k'));
    // The sky is no part of what is looked at from outside.
    expect(Math.hypot(...positionOf(outside))).toBeGreaterThan(1.2 * Math.hypot(...positionOf(first)));
    expect(Math.hypot(...positionOf(outside))).toBeLessThan(4);
    await after(page, () => page.keyboard.press('v'));
    const inside = await after(page, () => page.getByTestId('inside').click());
    expect(Math.hypot(...positionOf(inside))).toBeLessThan(Math.hypot(...positionOf(outside)));
    const turned = await after(page, () => page.getByTestId('flip').click());
    expect(turned.modelMatrices).not.toEqual([null]);
  });

  /**
   * @fault Files: two files are opened together whose axes up differ, in formats that name none
   */
  it('shows two files of different up axes upright', async () => {
    const page = await shareViewer(CHEAP, { viewport: { width: 480, height: 320 } });
    const bytes = await readFile(new URL('../packages/scenes/files/still-life-small.spz', import.meta.url));
    const set = await readSplats(bytes);
    // Half a turn about x, and beside the first.
    const turned = transformSplats(set, { rotation: [0, 1, 0, 0], translation: [0, 0, 3] });
    await dropFiles(page, [
      { name: 'up.ply', bytes: encodePly(set) },
      { name: 'down.ply', bytes: encodePly(turned) },
    ]);
    await waitForScene(page, 'up.ply and down.ply');
    const { modelMatrices, viewMatrix } = await drawnCamera(page);
    const heights = modelMatrices.map((matrix) => matrix?.[5] ?? 1);
    // The scene has y up, as the first file; the second one is turned.
    expect(heights).toEqual([1, -1]);
    expect(viewMatrix[5]).toBeGreaterThan(0.8);
  });

  it('focuses, zooms to the cursor, changes projection, field of view, up and background, flies, and keeps views', async () => {
    const page = await shareViewer(CHEAP, { viewport: { width: 480, height: 320 } });
    // The figures cover much of so small an image.
    await page.keyboard.press('h');
    const first = await drawnCamera(page);

    const focused = await after(page, () => page.mouse.dblclick(270, 180));
    // It moves sideways and does not turn.
    expectClose(rotationOf(focused), rotationOf(first));
    expect(focused.viewMatrix.slice(12, 14)).not.toEqual(first.viewMatrix.slice(12, 14));
    expect(focused.viewMatrix[14]).toBeCloseTo(first.viewMatrix[14], 5);

    await page.mouse.move(360, 160);
    const zoomed = await after(page, () => page.mouse.wheel(0, -240));
    // Towards the right of the image.
    expect(zoomed.viewMatrix[12]).toBeLessThan(focused.viewMatrix[12]);
    const home = await after(page, () => page.keyboard.press('r'));
    expectClose(home.viewMatrix, first.viewMatrix);

    // The picture makes room for the panel; the camera stays where it is.
    const beside = await after(page, () => page.keyboard.press('v'));
    expect(beside.viewMatrix).toEqual(home.viewMatrix);
    const area = await freeArea(page, beside);
    expect(area.freeMiddle[0]).toBeLessThan(200);
    expectClose(area.middle, area.freeMiddle);
    expect(area.tangent).toBeCloseTo(1 / home.projectionMatrix[5], 9);
    // Places are picked where they are seen.
    const middle = [Math.round(area.middle[0]), Math.round(area.middle[1])] as const;
    const near = await after(page, () => page.mouse.dblclick(middle[0] + 40, middle[1] + 40));
    const [right, down] = [12, 13].map((i) => near.viewMatrix[i] - beside.viewMatrix[i]);
    expect(right).toBeLessThan(0);
    // As far down as to the right, but for the pixels of the layer, which are 4 px wide.
    expect(Math.abs(down / -right - 1)).toBeLessThan(0.2);
    await after(page, () => page.keyboard.press('r'));
    await after(page, () =>
      page
        .getByTestId('save-view')
        .click()
        .then(() => page.keyboard.press('+')),
    );
    const parallel = await after(page, () => page.getByTestId('orthographic').click());
    expect(parallel.projectionMatrix[11]).toBe(0);
    await after(page, () => page.getByTestId('perspective').click());
    const wide = await after(page, () => page.getByTestId('fov').fill('90'));
    expect((await freeArea(page, wide)).tangent).toBeCloseTo(1, 5);
    const black = await after(page, () => page.getByTestId('background-black').click());
    expect(black.background).toEqual([0, 0, 0]);
    const turned = await after(page, () => page.getByTestId('up-z').click());
    // Horizons are level across z: the camera's right has no z.
    expect(turned.viewMatrix[8]).toBeCloseTo(0, 9);
    expect(turned.modelMatrices).toEqual([null]);

    await page.getByTestId('saved-view-1').waitFor();
    const again = await after(page, () => page.getByTestId('saved-view-1').click());
    expectClose(again.viewMatrix, first.viewMatrix);
    expectClose(again.projectionMatrix, beside.projectionMatrix);
    const alone = await after(page, () => page.keyboard.press('v'));
    expect(alone.projectionMatrix).toEqual(first.projectionMatrix);

    await page.keyboard.press('g');
    await page.getByTestId('travel').waitFor();
    expect(await textOf(page, 'travel')).toContain('1.0×');
    const flown = await after(page, async () => {
      await page.keyboard.down('w');
      await page.keyboard.up('w');
      await page.keyboard.press('e');
    });
    expect(positionOf(flown)).not.toEqual(positionOf(again));
    // It goes on as it looked.
    expectClose(rotationOf(flown), rotationOf(again));
    await page.keyboard.press('Escape');
    await page.getByTestId('travel').waitFor({ state: 'detached' });
    expect(await page.evaluate(() => document.pointerLockElement)).toBeNull();
  });
});
