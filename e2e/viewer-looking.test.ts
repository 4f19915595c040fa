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

/** The columns of the camera's rotation. */
const rotationOf = ({ viewMatrix }: DrawnCamera) => [0, 4, 8].flatMap((at) => viewMatrix.slice(at, at + 3));

/** Expects the same but for rounding. */
function expectClose(actual: readonly number[], expected: readonly number[]): void {
  const errors = actual.map((value, i) => Math.abs(value - expected[i]));
  expect(Math.max(...errors), `[${actual}] against [${expected}]`).toBeLessThan(1e-9);
}

describe('looking around in the viewer', () => {
  it('focuses, zooms to the cursor, changes projection, field of view, up and background, flies, and keeps views', async () => {
    const page = await openViewer(CHEAP, { viewport: { width: 480, height: 320 } });
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
    expectClose(again.viewMatrix, first.viewMatrix);
    expectClose(again.projectionMatrix, first.projectionMatrix);
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
    expectClose(rotationOf(flown), rotationOf(again));
    await page.keyboard.press('Escape');
    await page.getByTestId('flight').waitFor({ state: 'detached' });
    expect(await page.evaluate(() => document.pointerLockElement)).toBeNull();
  });
});
