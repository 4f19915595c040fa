import { encodePly } from '@websplatter/core';
import { expect, it } from 'vitest';
import { MIN_PSNR_DB, psnrAgainstReference } from '../reference.ts';
import { changedPart } from '../screenshot.ts';
import { testScene } from '../test-scene.ts';
import {
  drawnCamera,
  dropFiles,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForScene,
} from '../viewer-page.ts';

const { openViewer } = viewerHarness();

it('the viewer shows a PLY that is dropped, as the float64 reference does', async () => {
  const page = await openViewer('?scene=still-life-small', { viewport: { width: 160, height: 120 } });
  const before = await viewerScreenshot(page);
  const file = { name: 'test scene.ply', bytes: encodePly(testScene()) };
  await dropFiles(page, [file], async () => {
    expect(await page.getByTestId('drop-overlay').isVisible()).toBe(true);
  });
  await waitForScene(page, 'test scene.ply');
  expect(await page.getByTestId('drop-overlay').isVisible()).toBe(false);
  expect(await textOf(page, 'scene-title')).toBe('test scene.ply');
  expect(await textOf(page, 'scene')).toContain('400 splats');
  expect(await page.title()).toContain('test scene.ply');

  const shot = await viewerScreenshot(page);
  expect(changedPart(before, shot)).toBeGreaterThan(0.3);
  const drawn = await drawnCamera(page);
  // Files have y down, as captures do, and the viewer turns them.
  expect(drawn.modelMatrices[0]?.[5]).toBe(-1);
  expect(psnrAgainstReference(shot, drawn, [testScene()])).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  // The comparison can fail: against the scene the other way up, it does.
  const otherWayUp = { ...drawn, modelMatrices: [null] };
  expect(psnrAgainstReference(shot, otherWayUp, [testScene()])).toBeLessThan(MIN_PSNR_DB);
});
