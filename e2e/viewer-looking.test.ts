import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import {
  type DrawnCamera,
  drawnCamera,
  frameCount,
  textOf,
  viewerHarness,
  waitForFrameAfter,
} from './viewer-page.ts';

const { openViewer } = viewerHarness();
const CHEAP = '?scene=still-life-small&accuracy=fast,shDegree:0,resolutionScale:0.25,rasterizer:quads';

/** Does something that changes the image, and returns the camera of the image that follows. */
async function after(page: Page, act: () => Promise<unknown>): Promise<DrawnCamera> {
  const frames = await frameCount(page);
  await act();
  await waitForFrameAfter(page, frames);
  return drawnCamera(page);
}

/** The camera's position in the world. */
function positionOf({ viewMatrix: v }: DrawnCamera): number[] {
  return [0, 1, 2].map((axis) => -(v[4 * axis] * v[12] + v[4 * axis + 1] * v[13] + v[4 * axis + 2] * v[14]));
}

describe('looking around in the viewer', () => {
  it('focuses, zooms to the cursor, changes projection, field of view, up and background, flies, and keeps views', async () => {
    const page = await openViewer(CHEAP, { viewport: { width: 480, height: 320 } });
    const canvas = page.getByTestId('viewport');
    const first = await drawnCamera(page);

    const focused = await after(page, () => canvas.dblclick({ position: { x: 200, y: 200 } }));
    // It moves sideways and does not turn.
    expect(focused.viewMatrix.slice(0, 3)).toEqual(first.viewMatrix.slice(0, 3));
    expect(focused.viewMatrix.slice(12, 14)).not.toEqual(first.viewMatrix.slice(12, 14));
    expect(focused.viewMatrix[14]).toBeCloseTo(first.viewMatrix[14], 5);

    await page.mouse.move(360, 160);
    const zoomed = await after(page, () => page.mouse.wheel(0, -240));
    // Towards the right of the image.
    expect(zoomed.viewMatrix[12]).toBeLessThan(focused.viewMatrix[12]);
    const home = await after(page, () => page.keyboard.press('r'));
    expect(home.viewMatrix).toEqual(first.viewMatrix);

    await page.keyboard.press('v');
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
    expect(wide.projectionMatrix[5]).toBeCloseTo(1, 5);
    const black = await after(page, () => page.getByTestId('background-black').click());
    expect(black.background).toEqual([0, 0, 0]);
    const turned = await after(page, () => page.getByTestId('up-z').click());
    // Horizons are level across z: the camera's right has no z.
    expect(turned.viewMatrix[8]).toBeCloseTo(0, 9);
    expect(turned.modelMatrices).toEqual([null]);

    await page.getByTestId('saved-view-1').waitFor();
    const again = await after(page, () => page.getByTestId('saved-view-1').click());
    expect(again.viewMatrix).toEqual(first.viewMatrix);
    expect(again.projectionMatrix).toEqual(first.projectionMatrix);
    await page.keyboard.press('v');

    await page.keyboard.press('g');
    await page.getByTestId('flight').waitFor();
    expect(await textOf(page, 'flight')).toContain('1.0×');
    const flown = await after(page, async () => {
      await page.keyboard.down('w');
      await page.keyboard.up('w');
      await page.keyboard.press('e');
    });
    expect(positionOf(flown)).not.toEqual(positionOf(again));
    // It goes on as it looked.
    expect(flown.viewMatrix.slice(0, 3)).toEqual(again.viewMatrix.slice(0, 3));
    await page.keyboard.press('Escape');
    await page.getByTestId('flight').waitFor({ state: 'detached' });
    expect(await page.evaluate(() => document.pointerLockElement)).toBeNull();
  });
});
