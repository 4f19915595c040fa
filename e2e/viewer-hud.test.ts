// Proves: figures: true, frozen, copied, kept, without a write per frame.
import { readFile } from 'node:fs/promises';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { atRest } from './at-rest.ts';
import { CHEAP, drawnCamera, redraw, textOf, viewerHarness, waitForImage } from './viewer-page.ts';

/** Quads draw by few passes, each with a name. */
const BY_QUADS = CHEAP.replace('rasterizer:tiles', 'rasterizer:quads');
const harness = viewerHarness();
const { openViewer } = harness;
const SIZE = { width: 660, height: 490 };

/** Most updates of figures per millisecond, and how many more may lie at the ends of a measurement. */
const UPDATES_PER_MS = 1 / 250;
const UPDATES_AT_ENDS = 2;

/** Counts of a page: React's commits, and changes of the figures. */
interface Counts {
  commits: number;
  writes: number;
}

/** For `addInitScript`: counts what React commits, as its developer tools do. */
function countCommits(): void {
  const counts: Counts = { commits: 0, writes: 0 };
  const hook = {
    supportsFiber: true,
    renderers: new Map(),
    inject: () => 1,
    onCommitFiberRoot: () => counts.commits++,
    onCommitFiberUnmount: () => {},
    onPostCommitFiberRoot: () => {},
  };
  Object.assign(window, { counts, __REACT_DEVTOOLS_GLOBAL_HOOK__: hook });
}

function countsOf(page: Page): Promise<Counts> {
  return page.evaluate(() => ({ ...(window as unknown as { counts: Counts }).counts }));
}

/** Drags the scene and draws a frame for each step. */
async function drag(page: Page, frames: number): Promise<void> {
  await page.mouse.move(450, 400);
  await page.mouse.down();
  for (let step = 1; step <= frames; step++) {
    await redraw(page, () => page.mouse.move(450 + 4 * step, 400));
  }
  await page.mouse.up();
}

async function makeLarge(page: Page): Promise<void> {
  for (let size = 0; size < 2; size++) await page.getByTestId('hud-more').click();
  await page.getByTestId('left-peak').waitFor();
}

/** Waits until a figure matches `pattern`: measurements and figures follow their frames. */
const waitForFigure = (page: Page, testId: string, pattern: RegExp) =>
  expect.poll(() => textOf(page, testId), { message: testId }).toMatch(pattern);

/** How many different colours the chart of a side has. */
function chartColors(page: Page, side: 'left' | 'right'): Promise<number> {
  return page.getByTestId(`history-${side}`).evaluate((canvas: HTMLCanvasElement) => {
    const { data } = canvas.getContext('2d')!.getImageData(0, 0, canvas.width, canvas.height);
    return new Set(new Uint32Array(data.buffer)).size;
  });
}

describe('the figures of the viewer', () => {
  it('tell all that is known of the last frames, and render four times a second at most', async () => {
    const page = await harness.newPage({ viewport: SIZE });
    await page.addInitScript(countCommits);
    await page.goto(`${harness.server.url}${BY_QUADS}`);
    await waitForImage(page);
    await makeLarge(page);
    await drag(page, 2);
    await waitForFigure(page, 'left-peak', /\d/);
    await page.getByTestId('hud').evaluate((hud) => {
      const { counts } = window as unknown as { counts: Counts };
      new MutationObserver(() => counts.writes++).observe(hud, {
        attributes: true,
        characterData: true,
        childList: true,
        subtree: true,
      });
    });
    const before = await countsOf(page);
    const beganMs = performance.now();
    await drag(page, 6);
    const after = await countsOf(page);
    const elapsedMs = performance.now() - beganMs;
    expect(before.commits, 'commits of React so far').toBeGreaterThan(0);
    const most = elapsedMs * UPDATES_PER_MS + UPDATES_AT_ENDS;
    const commits = after.commits - before.commits;
    expect(commits, 'commits of React while frames were drawn').toBeLessThanOrEqual(most);
    expect(after.writes - before.writes, 'writes of figures').toBeLessThanOrEqual(most);
    await expect
      .poll(() => chartColors(page, 'left'), { message: 'colours of the chart' })
      .toBeGreaterThan(3);

    await waitForFigure(page, 'sort-keys', /^16 bits$/);
    await waitForFigure(page, 'candidate-splats', /^[\d,]+$/);
    expect(Number((await textOf(page, 'candidate-splats')).replaceAll(',', ''))).toBeGreaterThan(1000);
    await waitForFigure(page, 'memory-total', /^[\d.]+ MB$/);
    await waitForFigure(page, 'memory-limit', /^[\d.]+ [MG]B$/);
    for (const name of ['own-ms', 'render-ms']) await waitForFigure(page, name, /^[\d.,]+$/);
    // Tiles do not run the passes of quads.
    const passes = page.getByTestId('hud-passes');
    expect(await page.getByTestId('pass-rasterize').isVisible()).toBe(false);
    await passes.locator('summary').focus();
    await page.keyboard.press('Enter');
    await page.getByTestId('pass-rasterize').waitFor();
    await waitForFigure(page, 'pass-upscale', /^[\d.,]+$/);
    expect(await page.getByTestId('pass-tiles').isVisible()).toBe(false);

    // Both sides of a split image.
    await page.keyboard.press('c');
    await page.getByTestId('accuracy-tab-compare').click();
    await page.getByTestId('compare-split').click();
    await page.getByTestId('side-right').selectOption('fast');
    await waitForFigure(page, 'right-rasterizer', /tiles|quads/);
    await page.waitForFunction(() => {
      const names = ['preprocess-ms', 'rasterize-ms', 'rest-ms', 'total-ms', 'peak'];
      const times = document.querySelectorAll(names.map((name) => `[data-testid=right-${name}]`).join());
      return times.length === names.length && [...times].every(({ textContent }) => /\d/.test(textContent));
    });
    await page.keyboard.press('Escape');
    await expect.poll(() => chartColors(page, 'right')).toBeGreaterThan(2);
  });

  it('stand still when they are frozen, can be copied, and are as they were left after a reload', async () => {
    const page = await openViewer(CHEAP, {
      viewport: SIZE,
      permissions: ['clipboard-read', 'clipboard-write'],
    });
    await makeLarge(page);
    await drag(page, 2);
    const read = () => page.evaluate(() => navigator.clipboard.readText());
    const copy = async (format: 'json' | 'csv') => {
      await page.getByTestId(`hud-copy-${format}`).click();
      await page.getByTestId('hud-copied').getByText(`Copied as ${format.toUpperCase()}`).waitFor();
      return await read();
    };
    await waitForFigure(page, 'left-peak', /\d/);
    await page.getByTestId('hud-freeze').click();
    const frozen = JSON.parse(await copy('json'));
    const numbers = frozen.sides.left.frames.map(({ frame }: { frame: number }) => frame);
    expect(numbers.length).toBeGreaterThan(0);
    expect(frozen.sides.left.accuracy).toMatchObject({ resolutionScale: 0.25 });
    expect(await page.getByTestId('hud-freeze').getAttribute('aria-pressed')).toBe('true');
    expect(await textOf(page, 'hud-freeze')).toBe('Frozen');
    expect(await textOf(page, 'hud-headline')).toContain('frozen');
    const saved = page.waitForEvent('download');
    await page.getByTestId('hud-download-json').click();
    expect((await saved).suggestedFilename()).toBe('frame-figures.json');
    const inFile = JSON.parse(await readFile(await (await saved).path(), 'utf8'));
    expect(inFile.sides).toEqual(frozen.sides);
    const peak = await textOf(page, 'left-peak');
    await drag(page, 2);
    expect(await textOf(page, 'left-peak')).toBe(peak);
    const rows = (await copy('csv')).trim().split('\n');
    expect(rows[0]).toMatch(/^side,frame,/);
    expect(rows.slice(1).map((row) => Number(row.split(',')[1]))).toEqual(numbers);

    // Some browsers do not let pages copy.
    await page.evaluate(() => {
      navigator.clipboard.writeText = () => Promise.reject(new DOMException('', 'NotAllowedError'));
    });
    await page.getByTestId('hud-copy-csv').click();
    const report = page.getByTestId('hud-report');
    await report.waitFor();
    await page.waitForFunction(() => document.activeElement?.matches('[data-testid=hud-report]'));
    const selected = await report.evaluate((text: HTMLTextAreaElement) =>
      text.value.slice(text.selectionStart, text.selectionEnd),
    );
    expect(selected.trim().split('\n')).toEqual(rows);

    await page.reload();
    await page.getByTestId('hud').waitFor();
    expect(await page.getByTestId('hud').getAttribute('data-size')).toBe('large');
    expect(await page.getByTestId('hud-more').isDisabled()).toBe(true);
    for (let size = 0; size < 2; size++) await page.getByTestId('hud-fewer').click();
    expect(await page.getByTestId('total-ms').count()).toBe(0);
    expect(await page.getByTestId('hud').getAttribute('data-size')).toBe('small');
  });

  it('say in one line what the picture has cost, and leave the picture the rest of the window', async () => {
    const page = await harness.open(CHEAP, { viewport: { width: 900, height: 600 } });
    const headline = page.getByTestId('hud-headline');
    // Never a rate or a rest of nothing.
    expect(await headline.textContent()).toMatch(/^Loading|^[\d,.]+ ms to draw/);
    await waitForImage(page);
    const hud = page.getByTestId('hud');
    await expect.poll(() => headline.textContent()).toMatch(/^[\d,.]+ ms to draw, at rest$/);
    expect((await hud.boundingBox())!.height).toBeLessThan(50);
    const middle = async () => {
      const { projectionMatrix } = await drawnCamera(page);
      // Of the target, as a fraction of the picture's width.
      return (1 - projectionMatrix[8]) / 2;
    };
    expect(await middle()).toBeCloseTo(0.5);
    await redraw(page, () => page.getByTestId('hud-more').click());
    expect(await textOf(page, 'hud-headline')).toContain(await textOf(page, 'total-ms'));
    const { x, width } = (await hud.boundingBox())!;
    await atRest(page, middle);
    expect(await middle()).toBeCloseTo((x + width + 12 + 900) / 2 / 900, 2);

    // More figures than the window has room for can be scrolled to; a drag selects none.
    await page.setViewportSize({ width: 900, height: 500 });
    await page.getByTestId('hud-more').click();
    await expect
      .poll(() => hud.evaluate((each) => each.scrollHeight - each.clientHeight))
      .toBeGreaterThan(50);
    const box = (await hud.boundingBox())!;
    await page.mouse.move(box.x + 40, box.y + 100);
    await page.mouse.down();
    await page.mouse.move(box.x + 500, box.y + 300, { steps: 4 });
    await page.mouse.up();
    expect(await page.evaluate(() => String(getSelection()))).toBe('');
  });

  it('are closed at first on phones', async () => {
    const page = await harness.open(CHEAP, {
      viewport: { width: 360, height: 640 },
      hasTouch: true,
      isMobile: true,
    });
    await page.getByTestId('more').tap();
    const item = page.getByTestId('command-hud');
    expect(await item.getAttribute('aria-checked')).toBe('false');
    expect(await page.getByTestId('hud').count()).toBe(0);
    await item.tap();
    await page.getByTestId('hud').waitFor();
    const { width, height } = await page
      .getByTestId('hud-more')
      .evaluate((each) => each.getBoundingClientRect().toJSON());
    expect(Math.min(width, height), 'size of a button, px').toBeGreaterThanOrEqual(44);
  });
});
