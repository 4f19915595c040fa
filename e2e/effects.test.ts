// Proves: the viewer's list of effects with reasons and measured costs.
import { encodePly, type SplatSet } from '@websplatter/core';
import { LONG_PATIENCE_MS } from '@websplatter/tools/patience';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  clickInTurn,
  dropFiles,
  press,
  redraw,
  textOf,
  viewerHarness,
  waitForScene,
} from './viewer-page.ts';

const { shareViewer } = viewerHarness();
/** A measurement draws many frames, on the CPU. */
const TINY = { viewport: { width: 120, height: 90 } };

/** The test scene with spherical harmonics that are all zero. */
function withEmptyHarmonics(set: SplatSet): SplatSet {
  const { harmonics } = set;
  return {
    ...set,
    harmonics: { ...harmonics, coefficients: new Float32Array(harmonics.coefficients.length) },
  };
}

const effect = (page: Page, name: string) => page.getByTestId(`effect-${name}`);
const isOn = (page: Page, name: string) => effect(page, name).getAttribute('data-on');

async function open(page: Page, set: SplatSet): Promise<void> {
  await dropFiles(page, [{ name: 'test.ply', bytes: encodePly(set) }]);
  await waitForScene(page, 'test.ply');
}

describe('effects in the viewer', () => {
  it('lists what is in the image and what is not, and why', async () => {
    const page = await shareViewer('?scene=still-life-small', TINY);
    await page.keyboard.press('e');
    await page.getByTestId('effects').waitFor({ state: 'attached' });
    expect(await isOn(page, 'harmonics')).toBe('true');
    expect(await textOf(page, 'effects-verdict')).toMatch(
      /^\d+ of \d+ effects are in this frame\. The other \d+ cost nothing\.$/,
    );
    expect(await effect(page, 'harmonics').textContent()).toMatch(/1\.8 MB.*degree 3.*Acts in project/);
    expect(await isOn(page, 'transform')).toBe('false');
    expect(await isOn(page, 'fog')).toBe('false');
    const group = page.locator('.effect-group').filter({ has: effect(page, 'fog') });
    expect(await group.locator('.effect-reason').allTextContents()).toEqual(['no cloud asks for it']);
    expect(await group.locator('.effect').count()).toBeGreaterThan(5);

    // The viewer turns files, and the harmonics of this one are all zero.
    await open(page, withEmptyHarmonics(testScene()));
    expect(await isOn(page, 'harmonics')).toBe('false');
    expect(await effect(page, 'harmonics').textContent()).toContain('nothing above 0 could be seen');
    expect(await textOf(page, 'scene')).toContain('view-dependent colour (SH 1, seen up to SH 0)');
    expect(await isOn(page, 'transform')).toBe('true');
    expect(await effect(page, 'transform').textContent()).toContain('Acts in no shader');
    await redraw(page, () => page.keyboard.press('u'));
    expect(await isOn(page, 'transform')).toBe('false');

    // Only one panel is open at a time.
    await page.keyboard.press('c');
    await page.getByTestId('effects').waitFor({ state: 'detached' });
    await page.keyboard.press('e');
    await page.getByTestId('accuracy').waitFor({ state: 'detached' });
    await page.keyboard.press('Escape');
    await page.getByTestId('effects').waitFor({ state: 'detached' });
  });

  it('measures what effects cost, and can be cancelled', async () => {
    const page = await shareViewer(CHEAP, TINY);
    // Of few splats.
    await open(page, testScene());
    await page.keyboard.press('e');
    const cautions = page.getByTestId('effect-cautions');
    await clickInTurn(page, 'measure', 'cancel-sweep');
    await page.getByTestId('measure').waitFor({ state: 'attached' });
    expect(await cautions.count()).toBe(0);

    await redraw(page, () => press(page, 'switch-brightness'));
    await press(page, 'measure');
    await cautions.waitFor({ state: 'attached', timeout: LONG_PATIENCE_MS });
    expect(await textOf(page, 'cost-brightness')).toMatch(/^(too small to measure here|−?[\d.,]+ ms)$/);
    expect(await cautions.textContent()).toContain('without a GPU');
    expect(await effect(page, 'harmonics').textContent()).toMatch(
      /(?:\d ms|too small to measure here) · .*(of each frame|take the same|times of frames vary by)/,
    );
    expect(await effect(page, 'fog').textContent()).not.toContain('ms');
    expect(await cautions.getAttribute('data-stale')).toBe('false');
    await redraw(page, () => page.keyboard.press('ArrowRight'));
    expect(await cautions.getAttribute('data-stale')).toBe('true');
  });
});
