// Proves: the gallery of cases, and links to the lab.
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { textOf, viewerHarness, waitForState } from './viewer-page.ts';

const harness = viewerHarness();

/** Number of canvases of the page of a case that show something. */
function shownImages(page: Page): Promise<number> {
  return page.locator('[data-testid=case] canvas[data-shown=true]').count();
}

describe('the gallery of hard cases', () => {
  it('draws what comes into view, and shows expected and actual images of a case, the next and the one before', async () => {
    const page = await harness.openShared('lab/?gallery&q=scale');
    const drawn = page.locator('[data-testid=gallery] canvas[data-drawn]');
    await drawn.first().waitFor();
    // Far below is nothing drawn yet.
    expect(await drawn.count()).toBeLessThan(await page.locator('[data-testid=gallery] canvas').count());

    await page.locator('[data-case=scale-zero-all]').click();
    const verdict = page.getByTestId('case-verdict');
    await verdict.getByText('✓ The tests demand 55 dB.').waitFor();
    expect(await verdict.textContent()).toMatch(/^PSNR \d+\.\d dB\./);
    await expect.poll(() => shownImages(page)).toBe(4);
    // What breaks without the remedy can be seen.
    const addresses = await page
      .locator('[data-testid=case] canvas')
      .evaluateAll((all) => all.map((canvas) => (canvas as HTMLCanvasElement).toDataURL()));
    expect(addresses[3]).not.toBe(addresses[1]);
    expect(await textOf(page, 'case-legend')).toContain('Largest difference of a channel:');
    expect(new URL(page.url()).search).toBe('?gallery=&q=scale&case=scale-zero-all');

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

  it('says what has run on this device, case by case', async () => {
    const page = await harness.openShared('lab/?gallery&q=sort-0');
    const entry = page.locator('[data-case=sort-0-keys]');
    await entry.getByText('not run on this device').waitFor();
    await page.goto(`${harness.server.url}lab/?conformance&cases=sort-0-keys`);
    await page.getByTestId('run').click();
    await waitForState(page, 'done');
    await page.goto(`${harness.server.url}lab/?gallery`);
    await entry.getByText('✓ passes').waitFor();
    await page.locator('[data-case=scale-unit]').getByText('not run on this device').waitFor();
    await entry.click();
    await page.getByTestId('case').getByText('✓ passes').waitFor();
  });

  it('has words for pictures in which there is nothing to see', async () => {
    const page = await harness.openShared('lab/?gallery&q=counts-no');
    await page.locator('[data-case=counts-no-clouds]').getByText('nothing visible').waitFor();
  });

  it('has pages for files that must be refused, for cases without an image and for names that no case has', async () => {
    const page = await harness.openShared('lab/?gallery&case=input-truncated');
    await page
      .getByTestId('case-refusal')
      .getByText(/^Refused as truncated\. /)
      .waitFor();
    await page.goto(`${harness.server.url}lab/?gallery&case=sort-0-keys`);
    await page.getByTestId('case').getByText('Keys for the sort alone').waitFor();
    expect(await page.getByTestId('case-open').count()).toBe(0);
    const run = page.getByRole('link', { name: 'Run its tests on this device' });
    expect(await run.getAttribute('href')).toBe('?conformance&cases=sort-0-keys');
    await page.goto(`${harness.server.url}lab/?gallery&case=sort-0-kees`);
    await page.getByRole('link', { name: 'sort-0-keys' }).click();
    await page.getByRole('heading', { name: 'sort-0-keys' }).waitFor();
  });

  it('shows a refused file on a page of its own, from which it opens in the viewer, and that leads back', async () => {
    const page = await harness.openShared('lab/?gallery&q=truncated');
    await page.locator('[data-case=input-truncated]').click();
    await page
      .getByTestId('case-refusal')
      .getByText(/^Refused/)
      .waitFor();
    await page.getByTestId('case-open').click();
    await waitForState(page, 'error');
    expect(await textOf(page, 'scene-title')).toBe('input-truncated');
    expect(await textOf(page, 'scene')).toContain('No splats');
    expect(await textOf(page, 'error-message')).toContain('input-truncated');
    expect(await textOf(page, 'error')).toContain('The last 5 bytes are missing.');
    await page.getByRole('link', { name: 'All hard cases' }).click();
    await page.getByTestId('gallery').waitFor();
  });

  it('was in the viewer, as were the benchmark and the conformance page: old addresses lead to the lab', async () => {
    const page = await harness.newPage();
    await page.route('**/lab/**', (route) => route.fulfill({ body: 'the lab', contentType: 'text/html' }));
    for (const [old, moved] of [
      ['bench&cases=a', 'bench=&cases=a'],
      ['conformance&cases=a', 'conformance=&cases=a'],
      ['scene=hard', 'gallery='],
      ['scene=hard&q=b', 'gallery=&q=b'],
      ['scene=hard&case=a', 'gallery=&case=a'],
    ]) {
      await page.goto(`${harness.server.url}?${old}`);
      await page.getByText('the lab').waitFor();
      expect(page.url()).toBe(`${harness.server.url}lab/?${moved}`);
    }
  });

  it('says so where its code cannot be fetched', async () => {
    harness.expectProblem(/Failed to load resource/);
    harness.expectProblem(/Failed to fetch dynamically imported module/);
    const page = await harness.newPage();
    await page.route('**/lab/assets/gallery-page-*.js', (route) => route.abort());
    await page.goto(`${harness.server.url}lab/?gallery`);
    await page.getByTestId('page-failed').getByRole('button', { name: 'Try again' }).waitFor();
  });
});
