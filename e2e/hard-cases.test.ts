// Proves: the viewer opens a case by name, with its cameras.
import { HARD_CASES, type SceneCase } from '@websplatter/conformance';
import { type Harmonics, readSplats, type SplatSet } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { MIN_PSNR_DB, psnrAgainstReference } from './reference.ts';
import { changedPart } from './screenshot.ts';
import {
  drawnCamera,
  redraw,
  SMALL,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForScene,
} from './viewer-page.ts';

const harness = viewerHarness();
const ASPECT = SMALL.viewport.width / SMALL.viewport.height;

function sceneCase(name: string): SceneCase {
  const found = HARD_CASES.find((hardCase) => hardCase.name === name);
  if (found?.kind !== 'scene') throw new Error(`There is no scene case ${name}.`);
  return found;
}

/** Reads the splats of a case, independently of the viewer. */
function setsOf({ clouds }: SceneCase): Promise<SplatSet<Harmonics>[]> {
  return Promise.all(
    clouds().map((cloud) =>
      'set' in cloud ? cloud.set : readSplats(cloud.file, { name: 'case', shPrecision: 'f32' }),
    ),
  );
}

describe('hard cases', () => {
  it('are listed, searched by keyboard, opened, and seen from each of their cameras', async () => {
    const page = await harness.openShared('lab/?gallery', SMALL);
    const entries = page.getByTestId('gallery-case');
    await entries.first().waitFor();
    expect(await entries.count()).toBe(HARD_CASES.length);
    expect(await page.locator('[data-case]').count()).toBe(HARD_CASES.length);
    // Runs are kept by the page of conformance.
    expect(await page.getByTestId('gallery-verdict').count()).toBe(0);
    await page.evaluate(
      (text) => localStorage.setItem('websplatter-hard-cases', text),
      JSON.stringify({
        version: '1.2.3',
        passed: HARD_CASES.map(({ name }) => name),
        failed: [],
        date: '2026-11-25',
      }),
    );
    await page.reload();
    await entries.first().waitFor();
    expect(await textOf(page, 'gallery-verdict')).toContain(
      `${HARD_CASES.length} of ${HARD_CASES.length} cases pass on this device, by version 1.2.3, `,
    );

    await page.keyboard.type('camera orthographic means nothing');
    // React renders typed text with a delay.
    await expect.poll(() => textOf(page, 'gallery-count')).toBe(`1 of ${HARD_CASES.length}`);
    expect(await entries.count()).toBe(1);
    await expect
      .poll(() => new URL(page.url()).searchParams.get('q'))
      .toBe('camera orthographic means nothing');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('Enter');
    await page.getByTestId('case-open').click();
    const hardCase = sceneCase('camera-orthographic');
    await waitForScene(page, hardCase.name);
    expect(await textOf(page, 'scene-title')).toBe(hardCase.name);
    expect(await textOf(page, 'scene-topic')).toBe('Camera');
    expect(await textOf(page, 'scene-about')).toBe(hardCase.breaks);
    const casePage = page.getByTestId('scene').getByRole('link', { name: 'Expected and actual' });
    expect(await casePage.getAttribute('href')).toBe(`lab/?gallery&case=${hardCase.name}`);
    await page.keyboard.press('v');
    await page.getByTestId('view').waitFor();
    expect(await page.getByTestId('flip').isDisabled()).toBe(true);
    await page.keyboard.press('v');

    const sets = await setsOf(hardCase);
    const expectOwnImage = async (name: string) => {
      const drawn = await drawnCamera(page);
      const camera = hardCase.cameras(ASPECT)[name];
      expect(drawn.viewMatrix).toEqual(Array.from(camera.viewMatrix));
      expect(drawn.projectionMatrix).toEqual(Array.from(camera.projectionMatrix));
      const shot = await viewerScreenshot(page);
      expect(psnrAgainstReference(shot, drawn, sets)).toBeGreaterThanOrEqual(MIN_PSNR_DB);
      return shot;
    };
    const press = (key: string) => redraw(page, () => page.keyboard.press(key));
    await expectOwnImage('front');
    await press(']');
    expect(await textOf(page, 'camera')).toBe('oblique 2 of 2');
    const oblique = await expectOwnImage('oblique');

    // Movement continues in perspective, and Reset restores exactly the same image.
    await press('ArrowRight');
    expect((await drawnCamera(page)).projectionMatrix[11]).toBe(-1);
    expect(await textOf(page, 'camera')).toBe('oblique 2 of 2 · moved');
    await press('r');
    expect(changedPart(oblique, await viewerScreenshot(page), 0)).toBe(0);
    await press('[');
    expect(await textOf(page, 'camera')).toBe('front 1 of 2');
  });

  const shown = ['input-half-of-all-rows-nan', 'camera-off-centre', 'depth-all-equal-two-clouds'];
  it.each(shown)('shows %s as float64 defines it', async (name) => {
    const page = await harness.shareViewer(`?scene=hard:${name}`, SMALL);
    const hardCase = sceneCase(name);
    const drawn = await drawnCamera(page);
    const [camera] = Object.values(hardCase.cameras(ASPECT));
    expect(drawn.projectionMatrix).toEqual(Array.from(camera.projectionMatrix));
    const sets = await setsOf(hardCase);
    expect(drawn.modelMatrices).toHaveLength(sets.length);
    expect(psnrAgainstReference(await viewerScreenshot(page), drawn, sets)).toBeGreaterThanOrEqual(
      MIN_PSNR_DB,
    );
    const left = Object.values(hardCase.dropped ?? {}).reduce((sum, count) => sum + count, 0);
    if (left > 0) expect(await textOf(page, 'dropped')).toBe(`${left} left out`);
    expect(await page.getByTestId('dropped').count()).toBe(left > 0 ? 1 : 0);
  });

  it('shows a case of first cameras from the camera that is found', async () => {
    const page = await harness.shareViewer('?scene=hard:framing-room-with-z-up', SMALL);
    const { viewMatrix } = await drawnCamera(page);
    // y of the picture along z of the world.
    expect(viewMatrix[9]).toBeGreaterThan(0.9);
    expect(await textOf(page, 'scene-topic')).toBe('Framing');
  });

  it('offers similar names for one that does not exist', async () => {
    const page = await harness.openShared('?scene=hard:camera-ortographic', SMALL);
    await waitForScene(page, 'Still life, small', 'error');
    expect(await textOf(page, 'error-message')).toContain('“camera-ortographic”');
    const links = page.getByTestId('error').getByRole('link');
    expect(await links.first().getAttribute('href')).toBe('?scene=hard:camera-orthographic');
    expect(await links.last().getAttribute('href')).toBe('lab/?gallery');
    expect(await textOf(page, 'scene-title')).toContain('Still life');
  });
});
