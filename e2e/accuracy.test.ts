// Proves: the viewer's accuracy panel: detail, settings, split image, map of errors, measuring.
import { encodePly } from '@websplatter/core';
import { LONG_PATIENCE_MS } from '@websplatter/tools/patience';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { USES_GPU } from './browser.ts';
import { MIN_PSNR_DB, psnrAgainstReference, referenceImage } from './reference.ts';
import { changedPart, psnrOf, type Screenshot } from './screenshot.ts';
import { slowScene, testScene } from './test-scene.ts';
import {
  clickInTurn,
  drawnCamera,
  dropFiles,
  giveToolbarNoRoom,
  loseDeviceOnDemand,
  press,
  redraw,
  SMALL,
  showFigures,
  textOf,
  viewerHarness,
  viewerScreenshot,
  waitForImage,
  waitForScene,
  waitForState,
} from './viewer-page.ts';

const harness = viewerHarness({ 'test.ply': encodePly(testScene()) });
const { newPage, shareViewer } = harness;
/** A measurement draws a hundred frames, on the CPU. */
const TINY = { viewport: { width: 160, height: 120 } };
/** The figures and the panel beside each other. */
const WIDE = { viewport: { width: 900, height: 500 } };
/** A rasteriser that does not follow from times: images are compared bit for bit. */
const DETAILED = '?scene=still-life-small&accuracy=reference,rasterizer:tiles,resolutionScale:0.5';
/** Too slow to be moved by hand on SwiftShader. */
const SLOW = '?scene=still-life-small&accuracy=fast,rasterizer:tiles';
const ATTACHED = { state: 'attached' } as const;
/** The end of a measurement. */
const MEASURED = { state: 'attached', timeout: LONG_PATIENCE_MS } as const;
/** Most steps of 255 between images of equal settings: presets choose the rasteriser by times. */
const ROUNDING = 1;
const WITHOUT_LINE = '.split-line { visibility: hidden !important; }';

/** Draws with the highest cutoff, 0.1, that the slider has. */
async function chooseHighestCutoff(page: Page): Promise<void> {
  const slider = page.getByTestId('setting-alphaCutoff');
  await slider.fill((await slider.getAttribute('max')) ?? '');
}

/** Changes the image by `action`, and captures the new one. */
async function shotAfter(page: Page, action: () => Promise<unknown>): Promise<Screenshot> {
  await redraw(page, action);
  return viewerScreenshot(page);
}

const openTab = async (page: Page, tab: string) => {
  await page.keyboard.press('c');
  await press(page, `accuracy-tab-${tab}`);
};

/** Columns `from` up to `to` of an image. */
function columns({ data, widthPx, heightPx }: Screenshot, from: number, to: number): Screenshot {
  const rows = Array.from({ length: heightPx }, (_, y) =>
    data.subarray(4 * (y * widthPx + from), 4 * (y * widthPx + to)),
  );
  return { widthPx: to - from, heightPx, data: Uint8Array.from(rows.flatMap((row) => [...row])) };
}

/** Keeps a list of a page's buffers. */
function watchBuffers(): void {
  const { createBuffer } = GPUDevice.prototype;
  const { destroy } = GPUBuffer.prototype;
  const made: WatchedBuffer[] = [];
  const byBuffer = new WeakMap<GPUBuffer, WatchedBuffer>();
  GPUDevice.prototype.createBuffer = function (descriptor) {
    const buffer = createBuffer.call(this, descriptor);
    const watched = { label: descriptor.label ?? '', bytes: descriptor.size, isHeld: true };
    made.push(watched);
    byBuffer.set(buffer, watched);
    return buffer;
  };
  GPUBuffer.prototype.destroy = function () {
    const watched = byBuffer.get(this);
    if (watched) watched.isHeld = false;
    return destroy.call(this);
  };
  Object.assign(window, { buffersMade: made });
}

/**
 * For `addInitScript`: a measurement stands still until `release-measurement`. It may be over
 * in a second otherwise.
 */
function holdMeasurement(): void {
  const { mapAsync } = GPUBuffer.prototype;
  let release = () => {};
  const released = new Promise<void>((resolve) => {
    release = resolve;
  });
  addEventListener('release-measurement', () => release());
  GPUBuffer.prototype.mapAsync = async function (...range) {
    await mapAsync.apply(this, range);
    if (this.label === 'compare read-back') await released;
  };
}

const send = (page: Page, event: string) =>
  page.evaluate((type) => void dispatchEvent(new Event(type)), event);

/** Opens the viewer with a target, whose measurement stands still, and the panel that shows it. */
async function openHeld(script = () => {}): Promise<Page> {
  const page = await newPage(TINY);
  await page.addInitScript(holdMeasurement);
  await page.addInitScript(script);
  await page.goto(`${harness.server.url}?src=test.ply&accuracy=minPsnrDb:40`);
  await waitForImage(page);
  await openTab(page, 'measure');
  await page.getByTestId('sweep-progress').waitFor(ATTACHED);
  return page;
}

/** For `evaluate`: notes how much the widths of the presets' bars differ, CSS px, at each change of the panel. */
function noteBars(): void {
  const barSpreads: number[] = [];
  Object.assign(window, { barSpreads });
  new MutationObserver(() => {
    // Each list has a scale of its own: beside the own figures may be those of another device.
    for (const list of document.querySelectorAll('.preset-rows')) {
      const bars = [...list.querySelectorAll('.preset-bar')];
      const widths = bars.map((bar) => bar.getBoundingClientRect().width);
      if (widths.length > 1) barSpreads.push(Math.max(...widths) - Math.min(...widths));
    }
  }).observe(document.body, { childList: true, subtree: true });
}

const isPressed = (page: Page, testId: string) => page.getByTestId(testId).getAttribute('aria-pressed');

interface WatchedBuffer {
  readonly label: string;
  readonly bytes: number;
  isHeld: boolean;
}

const buffersLike = (page: Page, label: string) =>
  page.evaluate(
    (wanted) =>
      (window as unknown as { buffersMade: WatchedBuffer[] }).buffersMade.filter(
        (each) => each.label === wanted,
      ),
    label,
  );

const buffersMade = async (page: Page, label: string) => (await buffersLike(page, label)).length;

/** Sizes of the buffers with this label that have not been destroyed. */
const bytesHeld = async (page: Page, label: string) =>
  (await buffersLike(page, label)).filter(({ isHeld }) => isHeld).map(({ bytes }) => bytes);

describe('accuracy in the viewer', () => {
  it('draws with the setting that is chosen, and keeps it in the address', async () => {
    const page = await shareViewer('?src=test.ply', SMALL);
    await openTab(page, 'settings');
    // The panel leaves so little free that the scene would be small.
    for (let step = 0; step < 10; step++) await page.keyboard.press('+');
    // A CPU draws with the most exact settings, which take it less time than the usual default.
    expect(await page.getByTestId('preset-reference').getAttribute('aria-pressed')).toBe('true');
    await shotAfter(page, () => press(page, 'preset-balanced'));
    await page.waitForURL(/accuracy=balanced$/);
    const coarse = await shotAfter(page, () => chooseHighestCutoff(page));
    const drawn = await drawnCamera(page);
    const settings = { alphaCutoff: 0.1 };
    expect(psnrAgainstReference(coarse, drawn, [testScene()], { settings })).toBeGreaterThan(MIN_PSNR_DB);
    expect(psnrAgainstReference(coarse, drawn, [testScene()])).toBeLessThan(MIN_PSNR_DB);
    await page.waitForURL(/accuracy=balanced,alphaCutoff:0\.1$/);
    expect(await textOf(page, 'accuracy-custom')).toContain('balanced');

    const full = await shotAfter(page, () => press(page, 'preset-balanced'));
    expect(psnrAgainstReference(full, drawn, [testScene()])).toBeGreaterThan(MIN_PSNR_DB);
    await press(page, 'preset-reference');
    await page.waitForURL((url) => !url.search.includes('accuracy'));
  });

  it('reads a file whose rows the GPU takes, and again in the same way for finer planes, as float64 has it', async () => {
    const page = await newPage(TINY);
    await page.addInitScript(watchBuffers);
    await page.goto(`${harness.server.url}?src=test.ply&accuracy=balanced`);
    await waitForImage(page);
    // The picture makes room for the panel.
    await redraw(page, () => openTab(page, 'settings'));
    const set = testScene(70_000);
    await dropFiles(page, [{ name: 'many.ply', bytes: encodePly(set) }]);
    await waitForScene(page, 'many.ply');
    expect(await textOf(page, 'scene')).toContain('70,000 splats');
    expect(await bytesHeld(page, 'many.ply geometry 0')).toEqual([32 * set.count]);
    expect(await buffersMade(page, 'ingest rows')).toBe(1);
    const { width: widthPx, height: heightPx } = TINY.viewport;
    const psnrDb = referenceImage(await drawnCamera(page), [set], { widthPx, heightPx });
    expect(psnrDb(await viewerScreenshot(page))).toBeGreaterThanOrEqual(MIN_PSNR_DB);

    await press(page, 'preset-reference');
    await expect.poll(() => bytesHeld(page, 'many.ply geometry 0')).toEqual([64 * set.count]);
    expect(await buffersMade(page, 'ingest rows')).toBe(2);
    expect(await bytesHeld(page, 'ingest rows')).toEqual([]);
    await expect.poll(async () => psnrDb(await viewerScreenshot(page))).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('shows all of a file that arrives slowly, in full meanwhile, and tells how far it is read again, until that is cancelled', async () => {
    const page = await harness.openShared(
      '?file=/slow.ply&accuracy=balanced,rasterizer:tiles&detail=maxSplats:200',
      TINY,
    );
    // The rest comes only after the page has shown a part.
    await page.getByTestId('scene-title').getByText('slow.ply').waitFor(ATTACHED);
    await page.keyboard.press('ArrowRight');
    await openTab(page, 'settings');
    const reason = page.getByTestId('detail-dial').getByText('Drawn in full: the cloud is loading.');
    await reason.waitFor(ATTACHED);
    harness.server.sendRestOfSlowFile();
    await waitForScene(page, 'slow.ply');
    await reason.waitFor({ state: 'detached' });
    expect(await page.getByTestId('load').count()).toBe(0);
    expect(await textOf(page, 'scene')).toContain('80,000 splats');
    const whole = await shotAfter(page, () => press(page, 'detail-full'));
    expect(psnrAgainstReference(whole, await drawnCamera(page), [slowScene()])).toBeGreaterThanOrEqual(
      MIN_PSNR_DB,
    );

    const setting = page.getByTestId('setting-shPrecision');
    await setting.selectOption('f32');
    await page.getByTestId('preparing-figures').getByText(' of ').waitFor(ATTACHED);
    await press(page, 'cancel-preparing');
    await page.getByTestId('preparing').waitFor({ state: 'detached' });
    expect(await setting.inputValue()).toBe('u8');

    await setting.selectOption('f32');
    await page.getByTestId('preparing-figures').getByText(' of ').waitFor(ATTACHED);
    harness.server.sendRestOfSlowFile();
    await page.getByTestId('preparing').waitFor({ state: 'detached' });
    expect(await setting.inputValue()).toBe('f32');
  });

  it('opens with the accuracy of the address', async () => {
    const page = await shareViewer('?src=test.ply&accuracy=fast,sortKeyBits:32,rasterizer:quads', TINY);
    await openTab(page, 'settings');
    expect(await page.getByTestId('setting-sortKeyBits').inputValue()).toBe('32');
    expect(await page.getByTestId('setting-colorTarget').inputValue()).toBe('rgba8unorm');
    expect(await page.getByTestId('setting-rasterizer').inputValue()).toBe('quads');
    await showFigures(page);
    await page.getByTestId('rasterizer').getByText('quads').waitFor(ATTACHED);
    expect(await textOf(page, 'rasterizer-reason')).toBe('Quads were asked for');
  });

  it('splits the image between two settings, and maps the error of a coarse one, or of fast where reference is drawn', async () => {
    const page = await shareViewer('?scene=still-life-small&accuracy=alphaCutoff:0.1', SMALL);
    const left = await shotAfter(page, () => openTab(page, 'settings'));
    const right = await shotAfter(page, () => press(page, 'preset-balanced'));
    const part = (shot: Screenshot, side: 'left' | 'right') =>
      side === 'left' ? columns(shot, 0, 116) : columns(shot, 124, 240);
    expect(changedPart(part(left, 'left'), part(right, 'left'), 2)).toBeGreaterThan(0.01);
    expect(changedPart(part(left, 'right'), part(right, 'right'), 2)).toBeGreaterThan(0.01);

    await press(page, 'accuracy-tab-compare');
    await shotAfter(page, () => press(page, 'compare-split'));
    await shotAfter(page, () => page.getByTestId('side-right').selectOption('balanced'));
    await press(page, 'accuracy-tab-settings');
    await shotAfter(page, () => chooseHighestCutoff(page));
    const split = await viewerScreenshot(page, WITHOUT_LINE);
    expect(changedPart(part(split, 'left'), part(left, 'left'), ROUNDING)).toBe(0);
    expect(changedPart(part(split, 'right'), part(right, 'right'), ROUNDING)).toBe(0);
    expect(await textOf(page, 'split-label-left')).toMatch(/^A balanced, .* 0\.1$/);
    expect(await textOf(page, 'split-label-right')).toBe('B balanced');

    const line = page.getByTestId('split-line');
    await line.focus();
    await page.keyboard.press('Home');
    expect(await line.getAttribute('aria-valuenow')).toBe('0');
    const moved = await viewerScreenshot(page, WITHOUT_LINE);
    expect(changedPart(columns(moved, 4, 240), columns(right, 4, 240), ROUNDING)).toBe(0);

    // The left side's settings are those that are compared with `reference`.
    await press(page, 'accuracy-tab-compare');
    await press(page, 'compare-error');
    await page.getByTestId('error-max').getByText('Largest').waitFor();
    expect(await textOf(page, 'error-part-16+')).toMatch(/^(?!0 %)\d/);
    expect(await page.getByTestId('error-map').isVisible()).toBe(true);
    await shotAfter(page, () => press(page, 'preset-reference'));
    await page.getByTestId('error-max').getByText('Largest').waitFor();
    expect(await textOf(page, 'error-legend')).toContain('fast against reference');
    expect(await textOf(page, 'error-part-16+')).toBe('0 %');
    await press(page, 'compare-split');
    await page.getByTestId('split-label-right').waitFor(ATTACHED);
    expect(await textOf(page, 'split-label-left')).toBe('A reference');
    expect(await textOf(page, 'split-label-right')).toBe('B fast');
  });

  it('draws as many splats as the slider says, in a link too, and tells why where it draws all', async () => {
    const page = await shareViewer(DETAILED, WIDE);
    await giveToolbarNoRoom(page);
    const full = await viewerScreenshot(page);
    await page.keyboard.press('c');
    await showFigures(page);
    const slider = page.getByTestId('detail-slider');
    await slider.waitFor();
    const splatsDrawn = async () => Number((await textOf(page, 'visible-splats')).replaceAll(',', ''));
    await expect.poll(splatsDrawn).toBeGreaterThan(6000);
    await slider.scrollIntoViewIfNeeded();
    const { x, y, width, height } = (await slider.boundingBox())!;
    await redraw(page, () => page.mouse.click(x + 0.85 * width, y + height / 2));
    await redraw(page, () => page.keyboard.press('ArrowLeft'));
    const dial = page.getByTestId('detail-dial');
    const most = /Limited(\d,\d{3}) of 10,000 splats/.exec((await dial.textContent())!)?.[1] ?? '';
    expect(await page.getByTestId('detail-limited').getAttribute('aria-pressed')).toBe('true');
    await expect.poll(splatsDrawn).toBeLessThanOrEqual(Number(most.replaceAll(',', '')));
    await page
      .getByTestId('detail')
      .getByText(/^\d,\d{3} of 10,000 splats, up to \d+(\.\d+)? px off$/)
      .waitFor();
    // The figures hide a part of the picture, which is then not compared.
    await redraw(page, () => press(page, 'hud-fewer'));
    await redraw(page, () => slider.press('ArrowLeft'));
    await page.waitForURL(/detail=maxSplats:\d{4}$/);
    const shownDb = page.getByTestId('detail-db');
    await shownDb.waitFor();
    const detailDb = Number(/[\d.]+/.exec((await shownDb.textContent())!)?.[0]);

    // As it is embedded.
    await redraw(page, () => page.keyboard.press('Escape'));
    const fewer = await viewerScreenshot(page);
    expect(psnrOf(fewer, full)).toBeGreaterThan(30);
    expect(psnrOf(fewer, full)).toBeLessThan(60);
    // Of the part that the panel does not cover, and before it is rounded to bytes.
    expect(Math.abs(psnrOf(fewer, full) - detailDb)).toBeLessThan(3);
    const link = `${new URL(page.url()).search}&noui`;

    await redraw(page, () => page.keyboard.press('c'));
    await press(page, 'accuracy-tab-settings');
    await redraw(page, () => page.getByTestId('setting-recordPrecision').selectOption('paper'));
    await dial.getByText('Drawn in full: records of 24 bytes').waitFor();
    await showFigures(page);
    await page.getByTestId('detail').waitFor({ state: 'hidden' });
    await redraw(page, () => page.getByTestId('detail-full').click());
    await page.waitForURL(/detail=full$/);
    const still = await viewerScreenshot(page);
    await redraw(page, () => page.getByTestId('detail-auto').click());
    await page.waitForURL(/detail=auto$/);
    expect(changedPart(await viewerScreenshot(page), still, 0)).toBe(0);

    await shareViewer(link, WIDE);
    expect(changedPart(await viewerScreenshot(page), fewer, 0)).toBe(0);
  });

  it.skipIf(USES_GPU)(
    'draws fewer splats of a slow scene while it moves, unless told not to, and all at rest',
    async () => {
      const page = await shareViewer(SLOW, WIDE);
      await page.keyboard.press('c');
      await showFigures(page);
      await page.getByTestId('detail-dial').waitFor();
      const reason = page.getByTestId('detail-slow');
      expect(await reason.count()).toBe(0);
      const [x, y] = [430, 300];
      await page.mouse.move(x, y);
      await page.mouse.down();
      let moves = 0;
      const detailAfterMove = async () => {
        await page.mouse.move(x + (++moves % 60), y);
        return textOf(page, 'detail');
      };
      await expect.poll(detailAfterMove).toMatch(/^[\d,]+ of 10,000 splats/);
      await redraw(page, () => page.mouse.move(x - 30, y));
      await page.mouse.up();
      await reason.getByText(/^Coarser while moving: this device takes \d+ ms for a whole frame\./).waitFor();
      expect(await page.getByTestId('detail-full').getAttribute('aria-pressed')).toBe('false');
      expect(await page.getByTestId('detail-auto').getAttribute('aria-pressed')).toBe('true');
      await page.getByTestId('detail').waitFor({ state: 'hidden' });
      await page.waitForURL(/camera=(?!.*detail=)/);

      const still = await viewerScreenshot(page);
      await redraw(page, () => press(page, 'detail-full'));
      await page.waitForURL(/detail=full$/);
      await reason.waitFor({ state: 'detached' });
      expect(changedPart(await viewerScreenshot(page), still, 0)).toBe(0);
      await page.mouse.down();
      for (let step = 1; step <= 8; step++) {
        await page.mouse.move(x + step, y);
        expect(await textOf(page, 'detail')).toBe('');
      }
      await page.mouse.up();
    },
  );

  it('compares fewer splats with all of them', async () => {
    const full = await viewerScreenshot(await shareViewer(DETAILED, SMALL));
    const linked = `${DETAILED}&detail=maxSplats:1000`;
    const fewer = await viewerScreenshot(await shareViewer(linked, SMALL));
    const split = `${linked}&compare=current/reference,rasterizer:tiles,resolutionScale:0.5/0.5`;
    const page = await shareViewer(split, SMALL);
    expect(await textOf(page, 'split-label-left')).toMatch(/^A reference, .*, at most 1,000 splats$/);
    const shown = await viewerScreenshot(page, WITHOUT_LINE);
    const { widthPx } = shown;
    const halves = [0, 1].map((side) => [(side * widthPx) / 2 + 4, ((side + 1) * widthPx) / 2 - 4] as const);
    for (const [i, expected] of [fewer, full].entries())
      expect(changedPart(columns(shown, ...halves[i]), columns(expected, ...halves[i]), 0), `side ${i}`).toBe(
        0,
      );

    await page.keyboard.press('c');
    await press(page, 'accuracy-tab-compare');
    await press(page, 'compare-error');
    await page.getByTestId('error-max').getByText('Largest').waitFor();
    expect(await textOf(page, 'error-part-16+')).toMatch(/^(?!0 %)\d/);
    expect(await textOf(page, 'error-legend')).toContain('at most 1,000 splats against reference');
  });

  it('measures a scene that is opened later for the target, and shows other tabs meanwhile', async () => {
    const page = await openHeld();
    await press(page, 'accuracy-tab-settings');
    await page.getByTestId('setting-alphaCutoff').waitFor(ATTACHED);
    await press(page, 'accuracy-tab-measure');
    await dropFiles(page, [{ name: 'own.ply', bytes: encodePly(testScene(300)) }]);
    await send(page, 'release-measurement');
    await page.getByTestId('circumstances').getByText('300 splats').waitFor(MEASURED);
    await waitForScene(page, 'own.ply');
    expect(await textOf(page, 'measure-cautions')).toContain('without a GPU');
    const choice = page.getByTestId('choice');
    expect(await choice.getAttribute('data-met')).toBe('true');
    expect(await choice.textContent()).toContain('40 dB');
    const chosen = page.locator('[data-testid=point-table] tr:has([aria-pressed=true]) td').first();
    const psnrDb = Number((await chosen.textContent())?.replace('identical', 'Infinity'));
    expect(psnrDb).toBeGreaterThanOrEqual(40);
    await page.waitForURL(/accuracy=minPsnrDb:40/);
    // The images themselves say the same.
    const picked = await viewerScreenshot(page);
    // On a CPU the fastest settings may be those of reference: no frame would follow.
    const isExact = psnrDb === Number.POSITIVE_INFINITY;
    const exact = isExact ? picked : await shotAfter(page, () => press(page, 'preset-reference'));
    expect(psnrOf(picked, exact)).toBeGreaterThan(39);
  });

  it('keeps the choice of a target that is measured once more and cancelled, until a point is clicked', async () => {
    const page = await openHeld();
    await send(page, 'release-measurement');
    const choice = page.getByTestId('choice');
    await choice.waitFor(MEASURED);
    await page.getByTestId('target-value').fill('44');
    await press(page, 'target-submit');
    await choice.getByText('44 dB').waitFor(MEASURED);
    const target = page.getByTestId('kept-target');
    await clickInTurn(page, 'measure', 'cancel-sweep');
    await page.getByTestId('measure').waitFor(ATTACHED);
    expect(await choice.getAttribute('data-met')).toBe('true');
    expect(await target.textContent()).toBe('Chosen automatically: at least 44 dBStop');

    const other = page.locator('[data-testid=accuracy-point][aria-pressed=false]').last();
    await shotAfter(page, () => other.evaluate((button: HTMLElement) => button.click()));
    expect(await page.locator('[data-testid=accuracy-point][aria-pressed=true]').count()).toBe(1);
    await target.waitFor({ state: 'detached' });
    expect(await choice.count()).toBe(0);
  });

  it('measures presets, then every setting, where there is no target, and draws with the point that is clicked', async () => {
    const page = await shareViewer('?src=test.ply&accuracy=balanced,rasterizer:tiles', TINY);
    await redraw(page, () => openTab(page, 'measure'));
    const before = await viewerScreenshot(page);
    const points = page.getByTestId('accuracy-point');
    const rows = page.getByTestId('point-table').locator('tbody tr');
    const coarse = page.locator('[data-testid=accuracy-point][data-name="resolutionScale 0.5"]');
    await page.evaluate(noteBars);
    await press(page, 'measure');
    await page.locator('[data-testid=accuracy-point][data-name=paper]').waitFor(MEASURED);
    const presets = await points.count();
    expect(await rows.count()).toBe(presets);
    // The pictures follow: a row under the pointer shows its own.
    await page.getByTestId('preset-paper').locator('canvas').waitFor(MEASURED);
    await page.getByTestId('measure').waitFor(MEASURED);
    // At each moment all bars are of one scale: beside a picture, and where it is still to come.
    const spreads = await page.evaluate(() => (window as unknown as { barSpreads: number[] }).barSpreads);
    expect(spreads.length).toBeGreaterThan(1);
    expect(Math.max(...spreads)).toBeLessThan(0.5);
    expect(await textOf(page, 'verdict')).toMatch(/the exact picture/i);
    expect(await textOf(page, 'worst-crops')).toContain('has its largest errors');
    const looked = page.getByTestId('looked-picture');
    await page.getByTestId('preset-paper').dispatchEvent('pointerover');
    await looked.waitFor(ATTACHED);
    await page.getByTestId('worst-place').waitFor(ATTACHED);
    expect(changedPart(before, await viewerScreenshot(page), 0)).toBeGreaterThan(0);
    await page.getByTestId('preset-paper').dispatchEvent('pointerout');
    await looked.waitFor({ state: 'detached' });
    expect(changedPart(before, await viewerScreenshot(page), 0)).toBe(0);
    await page.getByTestId('measure-again').waitFor();
    await clickInTurn(page, 'measure', 'cancel-sweep');
    await page.getByTestId('measure').waitFor(ATTACHED);
    expect(await rows.count(), 'rows after a measurement that was called off').toBe(presets);
    await press(page, 'measure');
    await coarse.waitFor(MEASURED);
    expect(await coarse.getAttribute('aria-label')).toMatch(/^resolution 0\.5: \d/);
    expect(await rows.count()).toBe(await points.count());

    const clicked = await shotAfter(page, () => coarse.evaluate((button: HTMLElement) => button.click()));
    expect(await coarse.getAttribute('aria-pressed')).toBe('true');
    expect(changedPart(before, clicked, 2)).toBeGreaterThan(0.01);
    expect(await page.getByTestId('results').getAttribute('data-stale')).toBe('false');
    await shotAfter(page, () => page.keyboard.press('ArrowRight'));
    expect(await page.getByTestId('results').getAttribute('data-stale')).toBe('true');

    // Another page shows the same, and its picture makes room for a panel, too.
    await shareViewer('?src=test.ply&accuracy=resolutionScale:0.5', TINY);
    const shown = await shotAfter(page, () => openTab(page, 'settings'));
    expect(changedPart(clicked, shown, ROUNDING)).toBe(0);
  });

  it('measures a target anew when the device was lost, and ends one that is cancelled before it has chosen', async () => {
    const page = await openHeld(loseDeviceOnDemand);
    const target = page.getByTestId('kept-target');
    expect(await target.textContent()).toContain('Chosen automatically: at least 40 dB');
    expect(await textOf(page, 'accuracy-custom')).toBe('Drawn with balanced until this scene is measured');
    expect(await isPressed(page, 'preset-balanced')).toBe('false');
    const progress = page.getByTestId('sweep-progress');
    await send(page, 'lose-device');
    await progress.waitFor({ state: 'detached' });
    await waitForState(page, 'ready');
    await progress.waitFor(ATTACHED);
    expect(await target.textContent()).toContain('at least 40 dB');

    await press(page, 'cancel-sweep');
    await target.waitFor({ state: 'detached' });
    expect(await isPressed(page, 'preset-balanced')).toBe('true');
    await send(page, 'release-measurement');
    await page.getByTestId('measure').waitFor(ATTACHED);
    expect(await page.getByTestId('accuracy-point').count()).toBe(0);
  });
});
