import { encodePly, perspectiveCamera } from '@websplatter/core';
import { expect, it } from 'vitest';
import { appHarness } from './harness.ts';
import { drawnBy, MIN_PSNR_DB, psnrAgainstReference } from './reference.ts';
import { screenshot } from './screenshot.ts';
import { testScene } from './test-scene.ts';

const harness = appHarness('e2e/worker', { 'a.ply': encodePly(testScene()) });

it('a worker loads splats and draws them on the canvas of its page', async () => {
  const page = await harness.open('');
  await expect.poll(() => page.title()).toBe('drawn');
  const shot = await screenshot(page.locator('canvas'));
  const { widthPx, heightPx } = shot;
  const camera = perspectiveCamera({
    position: [1, 2, 5],
    target: [1, 1, 0],
    fovYDegrees: 50,
    aspect: widthPx / heightPx,
  });
  const drawn = drawnBy(camera, [0, 0, 0]);
  expect(psnrAgainstReference(shot, drawn, [testScene()])).toBeGreaterThanOrEqual(MIN_PSNR_DB);
});
