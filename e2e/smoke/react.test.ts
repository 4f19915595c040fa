import { encodePly } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { expect, it } from 'vitest';
import { atRest } from '../at-rest.ts';
import { appHarness } from '../harness.ts';
import type { CanvasDescription } from '../react/main.tsx';
import { MIN_PSNR_DB, psnrAgainstReference } from '../reference.ts';
import { screenshot } from '../screenshot.ts';
import { testScene } from '../test-scene.ts';

const harness = appHarness('e2e/react', { 'a.ply': encodePly(testScene()) });

/** Shows a Canvas with `splats`, which it draws on demand. */
function show(page: Page, splats: CanvasDescription['splats']): Promise<void> {
  const canvas = { id: 'canvas', kind: 'splats', frameloop: 'demand', background: 'black', splats } as const;
  return page.evaluate((described) => window.page.show([described]), canvas);
}

async function showSplats(page: Page, id: string): Promise<void> {
  await show(page, [{ id, src: 'a.ply' }]);
  await page.waitForFunction((entry) => window.page.log.includes(entry), `${id} firstframe`);
}

it('React draws <Splats> as the float64 reference does, and leaves nothing behind when they are unmounted', async () => {
  const page = await harness.open('');
  await page.waitForFunction(() => 'page' in window);
  await showSplats(page, 'first');
  const camera = await page.evaluate(() => {
    const { matrixWorldInverse, projectionMatrix, near, far } = window.page.canvases.get('canvas')!.camera;
    return {
      viewMatrix: matrixWorldInverse.elements,
      projectionMatrix: projectionMatrix.elements,
      near,
      far,
    };
  });
  const background: [number, number, number] = [0, 0, 0];
  const drawn = { ...camera, modelMatrices: [null], background };
  const shot = await screenshot(page.getByTestId('canvas'));
  expect(psnrAgainstReference(shot, drawn, [testScene()])).toBeGreaterThanOrEqual(MIN_PSNR_DB);

  const resources = () =>
    page.evaluate(() => ({
      ...window.page.countResources(),
      engineBytes: window.page.engine('canvas').memory().totalBytes,
    }));
  // The first mount makes objects that all others share: pipelines, and those that three keeps.
  await show(page, []);
  await expect.poll(resources).toMatchObject({ engineBytes: 0, workers: 0 });
  const before = await atRest(page, resources);
  await showSplats(page, 'second');
  await show(page, []);
  await expect.poll(resources).toEqual(before);
});
