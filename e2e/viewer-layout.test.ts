// Proves: nothing hides behind panels in any window; focus by keyboard.
import { encodePly } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { passTurns } from './at-rest.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  drawnCamera,
  dropFiles,
  frameCount,
  press,
  redraw,
  textOf,
  viewerHarness,
  waitForImage,
  waitForState,
} from './viewer-page.ts';

const harness = viewerHarness();
const { shareViewer } = harness;

const SIZES = [
  { width: 360, height: 640 },
  { width: 640, height: 360 },
  { width: 600, height: 420 },
  { width: 900, height: 600 },
  { width: 1440, height: 900 },
] as const;
/** Windows in which wide figures would reach below the toolbar. */
const FIGURES_MEET_TOOLBAR = [
  { width: 390, height: 844 },
  { width: 640, height: 400 },
  { width: 700, height: 500 },
  { width: 1024, height: 768 },
  { width: 1100, height: 700 },
  { width: 1280, height: 800 },
] as const;
/** The short run leaves out a size that has the layout of another one. */
const SWEPT =
  process.env.WEBSPLATTER_FULL === '1'
    ? SIZES
    : SIZES.filter(({ width, height }) => width !== 600 || height !== 420);

/**
 * Which of the elements that match `selectors` a person cannot see or touch: their middle, and what
 * lies within 2 px of their corners, is outside of the window or covered by something else.
 */
function hiddenAmong(page: Page, selectors: readonly string[]): Promise<string[]> {
  return page.evaluate((list) => {
    const isReached = (element: Element, x: number, y: number) => {
      const top = document.elementsFromPoint(x, y).find((each) => getComputedStyle(each).opacity !== '0');
      return top !== undefined && (element.contains(top) || top.contains(element));
    };
    return list.filter((selector) => {
      const element = document.querySelector<HTMLElement>(selector);
      if (!element) return true;
      // Elements that let pointers through are not found by their place.
      element.style.pointerEvents = 'auto';
      const { left, right, top, bottom, width, height } = element.getBoundingClientRect();
      const points = [
        [left + width / 2, top + height / 2],
        [left + 2, top + height / 2],
        [right - 2, top + height / 2],
        [left + width / 2, bottom - 2],
      ];
      const isSeen = width > 0 && height > 0 && points.every(([x, y]) => isReached(element, x, y));
      element.style.pointerEvents = '';
      return !isSeen;
    });
  }, selectors);
}

/** Resizes the window and lets the layout follow. */
async function resize(page: Page, size: { readonly width: number; readonly height: number }): Promise<void> {
  await page.setViewportSize(size);
  await page.waitForFunction(({ width, height }) => innerWidth === width && innerHeight === height, size);
  // The window has its size before the page is told.
  await page.evaluate(() => new Promise(requestAnimationFrame));
}

/** The toolbar's commands, by their rank. */
const RANKED = [
  'open',
  'save',
  'help',
  'view',
  'accuracy',
  'inspect',
  'effects',
  'select',
  'measure',
  'crop',
  'frame',
  'undo',
  'hud',
  'clouds',
  'reset',
  'annotate',
];
/** How many of them have buttons in windows of a width. */
const FITTING: Readonly<Record<number, number>> = { 360: 5, 600: 9, 640: 10, 900: 10, 1440: RANKED.length };

/** The toolbar's buttons where the window has this width. */
function toolbarAt({ width }: { readonly width: number }): string[] {
  const shown = RANKED.slice(0, FITTING[width]).map((name) => `command-${name}`);
  return [...shown, ...(shown.length < RANKED.length ? ['more'] : [])].map(
    (testId) => `[data-testid=${testId}]`,
  );
}

const focused = (page: Page) =>
  page.evaluate(() => (document.activeElement as HTMLElement | null)?.dataset.testid);

const box = (page: Page, testId: string) =>
  page.getByTestId(testId).evaluate((e) => e.getBoundingClientRect().toJSON());

describe('the viewer in windows of any size', () => {
  it('hides no control, no side of a split image and no figure behind panels and messages', async () => {
    const page = await shareViewer(CHEAP, { viewport: SIZES[3] });
    await page.getByTestId('command-accuracy').click();
    await page.getByTestId('accuracy-tab-compare').click();
    await page.getByTestId('compare-split').click();
    await page.getByTestId('split-line').waitFor();
    for (const size of SWEPT) {
      await resize(page, size);
      const name = `${size.width} × ${size.height}`;
      const panel = ['.dock h2', '.dock [aria-label=Close]', '[data-testid=accuracy-tab-settings]'];
      const split = ['[data-testid=split-label-left]', '[data-testid=split-label-right]', '.split-handle'];
      await expect
        .poll(() => hiddenAmong(page, [...toolbarAt(size), ...panel, ...split]), {
          message: `${name}, split`,
        })
        .toEqual([]);
      // The last control of the panel can be scrolled to.
      await page.getByTestId('side-right').scrollIntoViewIfNeeded();
      await expect
        .poll(() => hiddenAmong(page, ['[data-testid=side-right]']), { message: `${name}, scrolled` })
        .toEqual([]);
    }
    await page.keyboard.press('Escape');
    await page.evaluate(() => {
      const transfer = new DataTransfer();
      transfer.items.add(
        new File(['ply\nthat ends'], 'a file whose name is long enough to need a second line.ply'),
      );
      const canvas = document.querySelector('canvas');
      canvas?.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true }));
    });
    await waitForState(page, 'error');
    for (const size of SWEPT) {
      await resize(page, size);
      const seen = [...toolbarAt(size), '.hud-pace', '[data-testid=error] h2', '[data-testid=dismiss-error]'];
      await expect
        .poll(() => hiddenAmong(page, seen), { message: `${size.width} × ${size.height}, error` })
        .toEqual([]);
    }
    await page.keyboard.press('c');
    await page.locator('.dock h2').waitFor();
    for (const size of SWEPT.filter(({ width }) => width < 900)) {
      await resize(page, size);
      const seen = [...toolbarAt(size), '.hud-pace', '.dock h2', '[data-testid=dismiss-error]'];
      await expect
        .poll(() => hiddenAmong(page, seen), { message: `${size.width} × ${size.height}, error and panel` })
        .toEqual([]);
    }
  });

  it('leaves the buttons of the figures free at each of their sizes', async () => {
    const page = await shareViewer(CHEAP, { viewport: SIZES[4] });
    const sizes = ['hud-fewer', 'hud-more'].map((testId) => `[data-testid=${testId}]`);
    const hud = page.getByTestId('hud');
    for (const step of ['fewer', 'more', 'more'] as const) {
      await press(page, `hud-${step}`);
      const size = await hud.getAttribute('data-size');
      for (const window of [...SIZES, ...FIGURES_MEET_TOOLBAR]) {
        await resize(page, window);
        const name = `${window.width} × ${window.height}, ${size} figures`;
        await expect.poll(() => hiddenAmong(page, ['.toolbar', ...sizes]), { message: name }).toEqual([]);
      }
    }
    expect(await hud.getAttribute('data-size')).toBe('large');
  });

  it('has panels on phones whose height is changed by drags, taps and keys', async () => {
    const page = await shareViewer(CHEAP, { viewport: SIZES[0] });
    await page.getByTestId('more').click();
    await page.getByTestId('command-effects').click();
    const height = async () => Math.round((await box(page, 'effects')).height);
    const grip = page.getByTestId('sheet-grip');
    await expect.poll(height).toBe(320);
    // The picture has moved above the sheet, and the marks over it.
    await page.getByTestId('switch-volumes').click();
    await page.getByTestId('volume-handle').waitFor();
    await page.waitForFunction(
      () => document.querySelector('.volume-handle')!.getBoundingClientRect().bottom < 240,
    );
    await expect.poll(() => hiddenAmong(page, ['[data-testid=volume-handle]'])).toEqual([]);
    await page.getByTestId('switch-volumes').click();
    const { x, y, width, height: gripHeight } = await box(page, 'sheet-grip');
    expect(Math.min(width, gripHeight)).toBeGreaterThanOrEqual(44);
    const middle = [x + width / 2, y + 8] as const;
    await page.mouse.move(...middle);
    await page.mouse.down();
    await page.mouse.move(middle[0], 100, { steps: 4 });
    await page.mouse.up();
    expect(await grip.getAttribute('aria-valuetext')).toBe('full');
    await expect.poll(height).toBeGreaterThan(480);
    await expect.poll(() => hiddenAmong(page, [...toolbarAt(SIZES[0]), '.hud-pace', '.dock h2'])).toEqual([]);
    await page.keyboard.press('Home');
    expect(await grip.getAttribute('aria-valuetext')).toBe('low');
    await expect.poll(height).toBe(192);
    await page.mouse.click(middle[0], (await box(page, 'sheet-grip')).y + 8);
    expect(await grip.getAttribute('aria-valuetext')).toBe('half');
    // Thrown down, it closes.
    const at = (await box(page, 'sheet-grip')).y + 8;
    await page.mouse.move(middle[0], at);
    await page.mouse.down();
    await page.mouse.move(middle[0], 600, { steps: 4 });
    await page.mouse.up();
    await page.getByTestId('effects').waitFor({ state: 'detached' });
  });
});

describe('what takes its room, and no more', () => {
  it('frames the subject of a phone between the top and the caption', async () => {
    const page = await shareViewer(CHEAP, { viewport: SIZES[0] });
    const subject = async () => {
      const { projectionMatrix } = await drawnCamera(page);
      return (SIZES[0].height * (1 + projectionMatrix[9])) / 2;
    };
    const free = async () => (await box(page, 'scene')).top / 2;
    await expect.poll(async () => Math.abs((await subject()) - (await free()))).toBeLessThan(8);
    const withHint = await subject();
    // A gesture ends the hint, then the picture takes its place.
    await redraw(page, () => page.mouse.click(180, 200));
    await page.getByTestId('hint').waitFor({ state: 'detached' });
    await expect.poll(subject).toBeGreaterThan(withHint + 8);
    await expect.poll(async () => Math.abs((await subject()) - (await free()))).toBeLessThan(8);
  });

  it('makes an empty path as low as its words, sets buttons of a page apart, and leaves rows of files where they are', async () => {
    const page = await shareViewer(CHEAP, { viewport: SIZES[3] });
    await page.keyboard.press('q');
    await page.getByTestId('path-empty').waitFor();
    for (const size of [SIZES[0], SIZES[1], SIZES[3]]) {
      await resize(page, size);
      const strip = await box(page, 'path-strip');
      const words = await box(page, 'path-empty');
      const name = `${size.width} × ${size.height}`;
      expect(words.bottom, name).toBeLessThanOrEqual(strip.bottom);
      expect(strip.bottom - words.bottom, name).toBeLessThan(30);
      expect(strip.height, name).toBeLessThan(150);
    }
    await page.keyboard.press('q');
    await page.getByTestId('path-strip').waitFor({ state: 'detached' });

    await page.keyboard.press('x');
    await page.getByTestId('save-zip').waitFor();
    const [html, zip] = [await box(page, 'save-html'), await box(page, 'save-zip')];
    expect(zip.left - html.right).toBe(8);

    await page.keyboard.press('n');
    const eye = page.getByTestId('part-visible').first();
    await eye.waitFor();
    const placeOf = async () => {
      const { x, y } = (await eye.boundingBox())!;
      const part = (await page.getByTestId('part').first().boundingBox())!;
      return [x - part.x, y - part.y];
    };
    const alone = await placeOf();
    expect(Math.min(...alone)).toBeGreaterThanOrEqual(4);
    await dropFiles(page, [{ name: 'a.ply', bytes: encodePly(testScene()) }], undefined, { shiftKey: true });
    await expect.poll(() => page.getByTestId('part').count()).toBe(2);
    expect(await placeOf()).toEqual(alone);
    for (const isOpen of [true, false]) {
      await page.getByTestId('part-name').first().click();
      await expect.poll(() => page.locator('.part-form').count()).toBe(Number(isOpen));
      expect(await placeOf()).toEqual(alone);
    }
  });
});

describe('the keyboard in the viewer', () => {
  it('is shown where it is only when it is used, and moves what has it, not the scene', async () => {
    const page = await shareViewer(CHEAP, { viewport: SIZES[3] });
    const outline = () =>
      page.getByTestId('viewport').evaluate((canvas) => getComputedStyle(canvas).outlineStyle);
    await redraw(page, async () => {
      await page.mouse.move(400, 300);
      await page.mouse.down();
      await page.mouse.move(430, 310);
      await page.mouse.up();
    });
    expect(await focused(page)).toBe('viewport');
    expect(await outline()).toBe('none');
    await page.keyboard.press('Tab');
    await page.keyboard.press('Shift+Tab');
    expect(await focused(page)).toBe('viewport');
    expect(await outline()).toBe('solid');

    // One stop of the Tab key for the whole toolbar; arrows go along it.
    await page.keyboard.press('Tab');
    expect(await focused(page)).toBe('command-open');
    const frames = await frameCount(page);
    for (const [key, reached] of [
      ['ArrowRight', 'command-view'],
      ['End', 'more'],
      ['ArrowRight', 'command-open'],
      ['ArrowLeft', 'more'],
      ['Home', 'command-open'],
    ]) {
      await page.keyboard.press(key);
      expect(await focused(page), key).toBe(reached);
    }

    await passTurns(page);
    expect(await frameCount(page), 'frames drawn because of arrows').toBe(frames);
    await page.keyboard.press('c');
    await page.getByTestId('accuracy-tab-settings').click();
    const slider = page.getByTestId('setting-alphaCutoff');
    await slider.focus();
    const before = await box(page, 'setting-alphaCutoff');
    for (const key of ['ArrowRight', 'PageUp', 'ArrowLeft']) {
      await page.keyboard.press(key);
      expect((await box(page, 'setting-alphaCutoff')).y, `the slider's place after ${key}`).toBe(before.y);
    }
    expect(await textOf(page, 'accuracy-custom')).toContain('opacity cutoff');
    await waitForImage(page);
    const { viewMatrix } = await drawnCamera(page);
    await page.keyboard.press('?');
    await page.getByTestId('help').waitFor();
    await page.keyboard.press('Escape');
    await page.getByTestId('help').waitFor({ state: 'hidden' });
    expect(await focused(page)).toBe('setting-alphaCutoff');
    await redraw(page, () => page.keyboard.press('Escape'));
    expect(await page.getByTestId('accuracy').count()).toBe(0);
    expect((await drawnCamera(page)).viewMatrix, 'the camera').toEqual(viewMatrix);
  });
});
