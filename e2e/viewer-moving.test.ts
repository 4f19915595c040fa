// Proves: a moving scene is shown at a time, played, scrubbed and saved.
import { readFile } from 'node:fs/promises';
import { encodePly, MOTION_SLOT, MOTION_VALUES, readSplats } from '@websplatter/core';
import { splatsFromArrays } from '@websplatter/core/own-data';
import { describe, expect, it } from 'vitest';
import { changedPart } from './screenshot.ts';
import {
  CHEAP,
  dropFiles,
  IMAGE_ALONE,
  openSaveTab,
  redraw,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForScene,
} from './viewer-page.ts';

const { shareViewer } = viewerHarness();

const COUNT = 400;

/** A ring of splats, each there for a while; all turn about the middle. */
function ring() {
  const angles = Array.from({ length: COUNT }, (_, i) => (2 * Math.PI * i) / COUNT);
  const motion = new Float32Array(MOTION_VALUES * COUNT);
  for (const [i, angle] of angles.entries()) {
    const at = MOTION_VALUES * i;
    motion[at + MOTION_SLOT.time] = ((7 * i) % COUNT) / COUNT;
    motion[at + MOTION_SLOT.logDuration] = -2;
    motion.set([-Math.sin(angle), Math.cos(angle), 0], at + MOTION_SLOT.velocity);
  }
  const set = splatsFromArrays({
    positions: angles.flatMap((angle) => [Math.cos(angle), Math.sin(angle), 0]),
    scales: new Float32Array(3 * COUNT).fill(0.05),
    colors: angles.flatMap((angle) => [0.5 + 0.5 * Math.cos(angle), 0.5 + 0.5 * Math.sin(angle), 0.4]),
  });
  return { ...set, motion };
}

const SET = ring();

describe('a moving scene', () => {
  it('has a bar that scrubs and plays it', async () => {
    const page = await shareViewer(CHEAP, { viewport: { width: 480, height: 320 } });
    await dropFiles(page, [{ name: 'dancer.ply', bytes: encodePly(SET) }]);
    await waitForScene(page, 'dancer.ply');
    const time = page.getByTestId('scene-time');
    expect(await textOf(page, 'scene-time-text')).toBe('0.00');
    const picture = () => viewerScreenshot(page, IMAGE_ALONE);
    const first = await picture();
    await redraw(page, () => time.fill('0.5'));
    expect(await textOf(page, 'scene-time-text')).toBe('0.50');
    const half = await picture();
    expect(changedPart(first, half)).toBeGreaterThan(0.02);
    await redraw(page, () => time.press('Home'));
    expect(changedPart(first, await picture())).toBe(0);

    await page.getByTestId('play-scene').click();
    await expect.poll(() => time.inputValue().then(Number)).toBeGreaterThan(0.1);
    await page.getByTestId('play-scene').click();
    await page.waitForFunction(() => document.querySelector('canvas')?.dataset.resting === '');
    const paused = await time.inputValue();
    expect(Number(paused)).toBeGreaterThan(0.1);
    expect(await page.getByTestId('play-scene').getAttribute('aria-label')).toBe('Play the scene');
  });

  it('is gone with the next scene, which stands still', async () => {
    const page = await shareViewer(CHEAP, { viewport: { width: 480, height: 320 } });
    await dropFiles(page, [{ name: 'dancer.ply', bytes: encodePly(SET) }]);
    await waitForScene(page, 'dancer.ply');
    await page.getByTestId('scene-time').fill('0.75');
    const { motion: _, ...still } = SET;
    await dropFiles(page, [{ name: 'still.ply', bytes: encodePly(still) }]);
    await waitForScene(page, 'still.ply');
    expect(await page.getByTestId('time-bar').count()).toBe(0);
    await dropFiles(page, [{ name: 'dancer.ply', bytes: encodePly(SET) }]);
    await waitForScene(page, 'dancer.ply');
    expect(await textOf(page, 'scene-time-text')).toBe('0.00');
  });

  it('is saved with its motion as a PLY, and as it is shown in formats without one', async () => {
    const page = await shareViewer(CHEAP, { viewport: { width: 900, height: 600 } });
    await dropFiles(page, [{ name: 'dancer.ply', bytes: encodePly(SET) }]);
    await waitForScene(page, 'dancer.ply');
    await page.getByTestId('scene-time').fill('0.5');
    await openSaveTab(page, 'file');
    const saved = async (format: string) => {
      await page.getByTestId(`save-${format}`).click();
      const downloading = page.waitForEvent('download');
      await page.getByTestId('save-file').click();
      return readSplats(await readFile(await (await downloading).path()));
    };
    expect((await saved('ply')).motion).toHaveLength(15 * SET.count);
    const frozen = await saved('spz');
    expect(frozen.motion).toBeUndefined();
    expect(frozen.count).toBeLessThan(SET.count);
    await expect
      .poll(() => page.locator('.messages').innerText())
      .toMatch(/The scene moves, which .spz cannot hold/);
  });
});
