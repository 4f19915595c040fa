import { expect, it } from 'vitest';
import { appHarness } from '../harness.ts';
import { MIN_PSNR_DB, psnrAgainstReference } from '../reference.ts';
import { testScene } from '../test-scene.ts';
// Declares the page's interface for tests.
import type {} from '../three/main.ts';

const harness = appHarness('e2e/three');

async function openPage() {
  const page = await harness.openShared('');
  await page.waitForFunction(() => Boolean(window.cases));
  return page;
}

it('three draws a cloud under a matrix as the float64 reference does', async () => {
  const page = await openPage();
  const rigid = [0.8, 0, -0.6, 0, 0, 1, 0, 0, 0.6, 0, 0.8, 0, 0.2, 0.1, 0, 1];
  const drawn = await page.evaluate((matrix) => window.cases.transformed(matrix), rigid);
  const background: [number, number, number] = [0, 0, 0];
  const camera = { ...drawn.camera, modelMatrices: [drawn.modelMatrix], background };
  const shot = { ...drawn.image, data: Uint8Array.from(drawn.image.data) };
  expect(psnrAgainstReference(shot, camera, [testScene()])).toBeGreaterThan(MIN_PSNR_DB);
  const elsewhere = { ...camera, modelMatrices: [null] };
  expect(psnrAgainstReference(shot, elsewhere, [testScene()])).toBeLessThan(MIN_PSNR_DB);
});

it('three draws splats between meshes before and behind them', async () => {
  const page = await openPage();
  const { widthPx, heightPx, data } = await page.evaluate(() => window.cases.betweenMeshes({}));
  const pixelAt = (part: number) => {
    const i = 4 * (Math.floor(heightPx / 2) * widthPx + Math.floor(part * widthPx));
    return Array.from(data).slice(i, i + 3);
  };
  // A white splat of half opacity over a blue wall; a red wall before it.
  for (const [part, expected] of [
    [0.25, [128, 128, 255]],
    [0.75, [255, 0, 0]],
  ] as const) {
    const found = pixelAt(part);
    const difference = Math.max(...expected.map((value, channel) => Math.abs(found[channel] - value)));
    expect(difference, `found ${found}, expected ${expected}`).toBeLessThanOrEqual(2);
  }
});
