import { HARD_CASES } from '@websplatter/hardcases';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { clickInTurn, textOf, viewerHarness, waitForState } from './viewer-page.ts';

const harness = viewerHarness();

/** What the page has copied, in place of the clipboard, which a test's browser withholds. */
async function catchCopies(page: Page): Promise<() => Promise<string>> {
  await page.addInitScript(() => {
    navigator.clipboard.writeText = async (text) => {
      document.documentElement.dataset.copied = text;
    };
  });
  return () => page.evaluate(() => document.documentElement.dataset.copied ?? '');
}

/** Number of canvases of the page of a case that show something. */
function shownImages(page: Page): Promise<number> {
  return page.locator('[data-testid=case] canvas[data-shown=true]').count();
}

describe('the gallery of hard cases', () => {
  it('draws what comes into view, and shows expected and actual images of a case, the next and the one before', async () => {
    const page = await harness.open('?scene=hard&q=scale');
    const drawn = page.locator('[data-testid=gallery] canvas[data-drawn]');
    await drawn.first().waitFor();
    // Far below is nothing drawn yet.
    expect(await drawn.count()).toBeLessThan(await page.locator('[data-testid=gallery] canvas').count());

    await page.locator('[data-case=scale-zero-all]').click();
    const verdict = page.getByTestId('case-verdict');
    await verdict.getByText('✓ The tests demand 55 dB.').waitFor();
    expect(await verdict.textContent()).toMatch(/^PSNR \d+\.\d dB\./);
    await expect.poll(() => shownImages(page)).toBe(3);
    expect(await textOf(page, 'case-legend')).toContain('Largest difference of a channel:');
    expect(new URL(page.url()).search).toBe('?scene=hard&q=scale&case=scale-zero-all');

    const [before, next] = ['scale-zero-two-axes', 'scale-log-minus-100'];
    await page.keyboard.press('ArrowRight');
    await page.getByRole('heading', { name: next }).waitFor();
    await page.getByTestId('case-previous').click();
    await page.keyboard.press('ArrowLeft');
    await page.getByRole('heading', { name: before }).waitFor();
    await page.getByTestId('case-choose-balanced').click();
    await verdict.getByText('The tests only report it at balanced.').waitFor();

    await page.keyboard.press('Escape');
    await page.getByTestId('gallery').waitFor();
    await page.waitForSelector(`[data-case=${before}]:focus`);
    await page.goBack();
    await page.getByRole('heading', { name: before }).waitFor();
  });

  it('has pages for files that must be refused, for cases without an image and for names that no case has', async () => {
    const page = await harness.open('?scene=hard&case=input-truncated');
    await page
      .getByTestId('case-refusal')
      .getByText(/^Refused as truncated\. /)
      .waitFor();
    await page.goto(`${harness.server.url}?scene=hard&case=sort-0-keys`);
    await page.getByTestId('case').getByText('Keys for the sort alone').waitFor();
    expect(await page.getByTestId('case-open').count()).toBe(0);
    await page.goto(`${harness.server.url}?scene=hard&case=sort-0-kees`);
    await page.getByRole('link', { name: 'sort-0-keys' }).click();
    await page.getByRole('heading', { name: 'sort-0-keys' }).waitFor();
  });
});

describe('the page that runs the hard cases on a device', () => {
  it('runs them case by case, gives a report to copy, stops when asked to, and refuses names that no case has', async () => {
    const page = await harness.newPage();
    const copied = await catchCopies(page);
    await page.goto(`${harness.server.url}?conformance&cases=scale-unti`);
    await waitForState(page, 'failed');
    expect(await textOf(page, 'conformance-failure')).toBe('There is no hard case “scale-unti”.');

    await page.goto(`${harness.server.url}?scene=hard&case=sort-0-keys`);
    await page.getByRole('link', { name: 'Run its tests on this device' }).click();
    await page.getByTestId('conformance-run').click();
    await waitForState(page, 'done');
    const headline = `1 of 1 chosen hard cases (${HARD_CASES.length} in all) pass`;
    expect(await textOf(page, 'conformance-headline')).toBe(headline);
    expect(await textOf(page, 'conformance-results')).toContain('✓ passes');
    await page.getByTestId('conformance-copy-text').click();
    await expect.poll(copied).toContain(`WebSplatter: ${headline}\n`);
    expect(await copied()).toMatch(/^sort-0-keys .*pass$/m);
    await page.getByTestId('conformance-copy-json').click();
    await expect.poll(async () => (await copied()).startsWith('{')).toBe(true);
    expect(JSON.parse(await copied())).toMatchObject({
      casesChosen: 1,
      program: expect.stringContaining('Chrom'),
    });

    const sorts = HARD_CASES.filter(({ kind }) => kind === 'sort').map(({ name }) => name);
    await page.goto(`${harness.server.url}?conformance&cases=${sorts}`);
    await clickInTurn(page, 'conformance-run', 'conformance-stop');
    await waitForState(page, 'done');
    expect(await textOf(page, 'conformance-headline')).toContain('stopped before');
  });
});

describe('the benchmark', () => {
  it('measures a fixed path, gives a report to compare, and says why it cannot run or was cancelled', async () => {
    const page = await harness.newPage();
    const copied = await catchCopies(page);
    await page.goto(`${harness.server.url}?bench&size=64`);
    await waitForState(page, 'failed');
    expect(await textOf(page, 'bench-failure')).toContain('size is 64; write width and height in pixels');

    const address =
      '?bench&scene=hard:scale-unit&size=32x24&frames=3&accuracy=fast,sortKeyBits:32,rasterizer:quads';
    await page.goto(`${harness.server.url}${address}`);
    await waitForState(page, 'done');
    expect(await textOf(page, 'bench-times')).toContain('Of 3 frames');
    expect(await textOf(page, 'bench-facts')).toContain('3 frames over 15°, 32×24 px');
    // Nothing of the viewer is there, nor was it fetched.
    expect(await page.locator('.viewport, .overlay').count()).toBe(0);
    const fetched = await page.evaluate(() =>
      performance.getEntriesByType('resource').map(({ name }) => name),
    );
    const has = (script: string) => fetched.some((name) => name.includes(`/assets/${script}-`));
    expect([has('bench-page'), has('shared'), has('viewer')]).toEqual([true, true, false]);
    await page.getByTestId('bench-copy-json').click();
    await expect.poll(copied).toContain('"measurement"');
    expect(JSON.parse(await copied())).toMatchObject({
      scene: { title: 'scale-unit', clouds: 1 },
      sweepDegrees: 15,
      accuracy: { sortKeyBits: 32, rasterizer: 'quads' },
      measurement: { widthPx: 32, heightPx: 24, frames: 3, wallClockMs: { median: expect.any(Number) } },
    });
    const saved = page.waitForEvent('download');
    await page.getByTestId('bench-save-json').click();
    expect((await saved).suggestedFilename()).toMatch(/^websplatter-bench-scale-unit-.*\.json$/);

    const reports = page.getByTestId('bench-reports');
    const report = { name: 'a.json', mimeType: 'application/json', buffer: Buffer.from(await copied()) };
    await reports.setInputFiles(report);
    await expect.poll(() => page.getByTestId('bench-compared').getByRole('row').count()).toBeGreaterThan(1);
    await reports.setInputFiles({ ...report, buffer: Buffer.from('{}') });
    await page.getByRole('status').getByText('a.json is no report of this benchmark.').waitFor();

    await clickInTurn(page, 'bench-again', 'bench-cancel');
    await waitForState(page, 'cancelled');
  });
});
