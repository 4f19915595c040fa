// Proves: view modes show what their legends say, as in float64.
import { encodePly } from '@websplatter/core';
import type { EffectUse } from '@websplatter/core/effects';
import type { EffectReference, ReferenceFunction } from '@websplatter/core/reference';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import {
  CENTRE_RADIUS_PX,
  centres,
  depthColors,
  ELLIPSOID_DARKEST,
  ELLIPSOID_EDGE,
  ELLIPSOID_SHRINKING,
  ellipsoids,
  harmonicsColors,
  levelColors,
  MOST_STEPS,
  OVERDRAW_OPACITY,
  opacityColors,
  overdraw,
} from '../apps/viewer/src/view-modes/mode-effects.ts';
import { DEPTH_RAMP, OVERDRAW_COLOR, type Ramp, VALUE_RAMP } from '../apps/viewer/src/view-modes/ramp.ts';
import { MIN_PSNR_DB, referenceImage } from './reference.ts';
import type { Screenshot } from './screenshot.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  drawnCamera,
  dropFiles,
  redraw,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForScene,
} from './viewer-page.ts';

const SCENE = testScene();
const PLY = encodePly(SCENE);
const { shareViewer } = viewerHarness({ 'own.ply': PLY });

type Color = readonly [number, number, number];

const mapped = (map: (channel: number) => number): Color => [map(0), map(1), map(2)];
const along = ({ low, high }: Ramp, part: number) =>
  mapped((c) => (low.color[c] + (high.color[c] - low.color[c]) * Math.min(1, Math.max(0, part))) / 255);

/** The splat shrunk by `factor`, and with another opacity. */
function solid(factor: number, opacity: (dilationPx2: number) => number): EffectReference {
  return {
    changeSplat(splat) {
      const [x, y, z] = splat.logScales.map((value) => value + Math.log(factor));
      return { ...splat, logScales: [x, y, z] };
    },
    changeOpacity: (_, { dilationPx2 }) => opacity(dilationPx2),
  };
}

/** Each mode in float64, by the words of its legend. */
const REFERENCES = {
  ellipsoids: () => ({
    ...solid(ELLIPSOID_SHRINKING, () => 0.5 / Math.exp(-0.5 * (ELLIPSOID_EDGE / ELLIPSOID_SHRINKING) ** 2)),
    changeColor(color, _, index) {
      const part = (Math.imul(index, 2654435769) >>> 8) / 2 ** 24;
      return mapped((c) => color[c] * (ELLIPSOID_DARKEST + (1 - ELLIPSOID_DARKEST) * part));
    },
  }),
  // Smaller than float32 tells from 0 beside the dilation.
  centres: () => solid(1e-9, (dilationPx2) => 0.5 / Math.exp((-0.5 * CENTRE_RADIUS_PX ** 2) / dilationPx2)),
  depth: ([near, , , , far]) => ({
    changeColor: (_color, _splat, _index, [, , z]) =>
      along(DEPTH_RAMP, (1 / near - 1 / Math.max(-z, near)) / (1 / near - 1 / far)),
  }),
  opacity: () => ({ changeColor: (_, { opacity }) => along(VALUE_RAMP, opacity) }),
  harmonics: () => ({
    changeColor(color, { row }) {
      const base = mapped((c) => Math.max(0, 0.5 + SCENE.colorDc[3 * row + c] * Math.sqrt(0.25 / Math.PI)));
      return along(
        VALUE_RAMP,
        (255 / MOST_STEPS) * Math.max(...mapped((c) => Math.abs(Math.max(0, color[c]) - base[c]))),
      );
    },
  }),
  overdraw: () => ({
    changeOpacity: () => OVERDRAW_OPACITY,
    changeColor: () => mapped((c) => OVERDRAW_COLOR.color[c] / 255),
  }),
  // All splats are drawn in full here; coarser levels are tested where they are chosen.
  detail: () => ({ changeColor: () => along(VALUE_RAMP, 0) }),
} as const satisfies Record<string, (ticks: readonly number[]) => EffectReference>;

const anywhere = { bounds: { center: [0, 0, 0], radius: 1 }, focusDistance: () => 1 } as const;
const USES: Readonly<Record<keyof typeof REFERENCES, EffectUse>> = {
  ellipsoids: ellipsoids(),
  centres: centres(),
  depth: depthColors(anywhere),
  opacity: opacityColors(),
  harmonics: harmonicsColors(),
  overdraw: overdraw(),
  detail: levelColors(),
};

/** Draws the screen's frame in `mode`, in float64; returns a function for screenshots' PSNR. */
async function reference(page: Page, mode: keyof typeof REFERENCES, size: Screenshot) {
  const ticks = await page.getByTestId('mode-scale').locator('li').allTextContents();
  const ofMode: ReferenceFunction = () => REFERENCES[mode](ticks.map((text) => Number.parseFloat(text)));
  const use = USES[mode];
  const effects = { effects: [use], effectReferences: { [use.effect.name]: ofMode } };
  return referenceImage(await drawnCamera(page), [SCENE], size, effects);
}

/** Notes that legends of maps must have, with numbers of a scene of so many splats. */
const NOTES = {
  'tile-cost': /^At most (\d+), (\d+) on average in a list\.$/,
  'pixel-cost': /^At most (\d+), (\d+) on average at a pixel; (\d+) % of them are blended/,
  contribution: /^(\d+) of (\d+) splats in the picture \((?:< )?(\d+) %\) contribute less/,
} as const;

/** Waits for the map of a mode, and looks at its size, at its colours and at its numbers. */
async function checkMap(page: Page, mode: keyof typeof NOTES): Promise<void> {
  const notes = page.getByTestId('map-notes');
  await notes.filter({ hasText: NOTES[mode] }).waitFor();
  const found = NOTES[mode].exec((await notes.textContent()) ?? '') ?? [];
  const [first, second] = found.slice(1).map(Number);
  if (mode === 'contribution') expect(first).toBeLessThan(second);
  else expect(first).toBeGreaterThan(second);
  expect(second).toBeLessThanOrEqual(SCENE.count);
  const map = await page.getByTestId('mode-map').evaluate((canvas: HTMLCanvasElement) => {
    const { width, height, hidden } = canvas;
    const { data } = canvas.getContext('2d')!.getImageData(0, 0, width, height);
    return { width, height, hidden, colors: new Set(new Uint32Array(data.buffer)).size };
  });
  expect(map).toMatchObject({ width: 300, height: 200, hidden: false });
  expect(map.colors, mode).toBeGreaterThan(10);
}

/** So small that the float64 reference is quick. */
const WINDOW = { viewport: { width: 300, height: 200 } };

/** Opens the test's own scene, in a window that tests share, as `mode` shows it. */
function openScene(mode: string): Promise<Page> {
  return shareViewer(`?src=own.ply&mode=${mode}&accuracy=reference,rasterizer:tiles`, WINDOW);
}

const waitForMode = (page: Page, mode: string) => page.waitForURL(new RegExp(`[?&]mode=${mode}(&|$)`));

describe('view modes of the viewer', () => {
  it('show what their legends say, as float64 does, in the next scene too', async () => {
    const page = await openScene('ellipsoids');
    await dropFiles(page, [{ name: 'next.ply', bytes: PLY }]);
    await waitForScene(page, 'next.ply');
    let before: Screenshot | null = null;
    for (const mode of Object.keys(REFERENCES) as (keyof typeof REFERENCES)[]) {
      if (mode !== 'ellipsoids') await redraw(page, () => page.keyboard.press('m'));
      expect((await textOf(page, 'mode-legend')).toLowerCase()).toContain(mode);
      await waitForMode(page, mode);
      const shot = await viewerScreenshot(page);
      const psnrDb = await reference(page, mode, shot);
      expect(psnrDb(shot), mode).toBeGreaterThanOrEqual(MIN_PSNR_DB);
      if (before) expect(psnrDb(before), `what was shown before ${mode}`).toBeLessThan(MIN_PSNR_DB - 10);
      before = shot;
    }
  });

  it('map what a frame costs, and what splats contribute, with numbers that are older while the camera moves', async () => {
    const page = await openScene('tile-cost');
    for (const mode of ['tile-cost', 'pixel-cost', 'contribution'] as const) {
      if (mode !== 'tile-cost') await page.keyboard.press('m');
      await waitForMode(page, mode);
      await checkMap(page, mode);
    }
    const notes = page.getByTestId('map-notes');
    await notes.evaluate((element) => {
      const note = () => {
        if (element.textContent?.startsWith('As of the last rest: ')) element.dataset.wasOlder = '';
      };
      new MutationObserver(note).observe(element, { childList: true, characterData: true, subtree: true });
    });
    await redraw(page, () => page.getByTestId('viewport').press('ArrowLeft'));
    await checkMap(page, 'contribution');
    expect(await notes.getAttribute('data-was-older')).toBe('');

    await page.keyboard.press('m');
    await page.getByTestId('mode-legend').waitFor({ state: 'detached' });
    await page.waitForURL((url) => !url.searchParams.has('mode'));
  });

  it('are chosen and left in a panel', async () => {
    const page = await shareViewer(CHEAP, { viewport: { width: 900, height: 600 } });
    await redraw(page, () => page.keyboard.press('v'));
    await redraw(page, () => page.getByTestId('mode-depth').click());
    expect(await page.getByTestId('mode-depth').getAttribute('aria-pressed')).toBe('true');
    await redraw(page, () => page.getByRole('button', { name: 'Back to colours' }).click());
    expect(await page.getByTestId('mode-colours').getAttribute('aria-pressed')).toBe('true');
  });
});
