// Proves: the lab runs hard cases and measures frames, with reports to save and compare; axe-core.
import { readFile } from 'node:fs/promises';
import { HARD_CASES } from '@websplatter/conformance';
import { encodePly } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { AXE, expectAccessible } from './accessible.ts';
import { appHarness } from './harness.ts';
import { testScene } from './test-scene.ts';
import { clickInTurn, textOf, waitForState } from './viewer-page.ts';

const harness = appHarness('apps/lab', { 'scene.ply': encodePly(testScene()) });

/** Text copied by the page, in place of the clipboard, which a test's browser withholds. */
async function catchCopies(page: Page): Promise<() => Promise<string>> {
  await page.addInitScript(() => {
    navigator.clipboard.writeText = async (text) => {
      document.documentElement.dataset.copied = text;
    };
  });
  return () => page.evaluate(() => document.documentElement.dataset.copied ?? '');
}

const copy = (page: Page, format: string) => page.getByRole('button', { name: `Copy as ${format}` }).click();

describe('the page that runs hard cases in any browser', () => {
  it('refuses names that no case has', async () => {
    const page = await harness.openShared('?conformance&cases=scale-unti');
    await waitForState(page, 'failed');
    expect(await textOf(page, 'failure')).toBe('There is no hard case “scale-unti”.');
    expect(await page.getByTestId('run').count()).toBe(0);
  });

  it('runs those of its address case by case, and gives a report to copy', async () => {
    const page = await harness.newPage();
    const copied = await catchCopies(page);
    await page.goto(`${harness.server.url}?conformance&cases=sort-0-keys,input-truncated`);
    await page.getByTestId('run').click();
    await waitForState(page, 'done');
    const headline = `2 of 2 chosen hard cases (${HARD_CASES.length} in all) pass`;
    expect(await textOf(page, 'headline')).toBe(headline);
    await expect.poll(() => page.evaluate(() => document.activeElement?.id)).toBe('headline');
    expect(await textOf(page, 'results')).toContain('✓ passes');
    await copy(page, 'text');
    await expect.poll(copied).toContain(`WebSplatter: ${headline}\n`);
    expect(await copied()).toMatch(/^sort-0-keys .*pass$/m);
    await copy(page, 'JSON');
    await expect.poll(async () => (await copied()).startsWith('{')).toBe(true);
    expect(JSON.parse(await copied())).toMatchObject({
      casesChosen: 2,
      program: expect.stringContaining('Chrom'),
    });
  });

  it('selects the report to be copied by hand where the browser does not let the page copy', async () => {
    const page = await harness.newPage();
    await page.addInitScript(() => {
      navigator.clipboard.writeText = async () => {
        throw new DOMException('Write permission denied.', 'NotAllowedError');
      };
    });
    await page.goto(`${harness.server.url}?conformance&cases=sort-0-keys`);
    await page.getByTestId('run').click();
    await waitForState(page, 'done');
    await copy(page, 'JSON');
    await expect.poll(() => textOf(page, 'copied')).toContain('Copy the selected text');
    await expect.poll(() => page.evaluate(() => String(getSelection()))).not.toBe('');
    expect(JSON.parse(await page.evaluate(() => String(getSelection())))).toMatchObject({ casesChosen: 1 });
  });

  it('stops when it is asked to, after the case that has begun', async () => {
    const sorts = HARD_CASES.filter(({ kind }) => kind === 'sort').map(({ name }) => name);
    const page = await harness.openShared(`?conformance&cases=${sorts}`);
    await clickInTurn(page, 'run', 'stop');
    await waitForState(page, 'done');
    expect(await textOf(page, 'headline')).toContain('stopped before');
  });

  it('keeps what has run, and begins with what has not', async () => {
    const page = await harness.openShared('?conformance&cases=sort-0-keys');
    expect(await page.getByTestId('kept-run').count()).toBe(0);
    await page.getByTestId('run').click();
    await waitForState(page, 'done');
    await page.goto(`${harness.server.url}?conformance&cases=sort-0-keys,input-truncated`);
    const others = HARD_CASES.length - 1;
    expect(await textOf(page, 'kept-run')).toContain(
      `1 of ${HARD_CASES.length} cases pass on this device: ${others} have not run, by version`,
    );
    await page.getByTestId('run').click();
    await waitForState(page, 'done');
    const names = await page.locator('[data-testid=results] tbody a').allTextContents();
    expect(names).toEqual(['input-truncated', 'sort-0-keys']);
  });
});

const start = (page: Page) => page.getByTestId('start').click();

describe('the benchmark', () => {
  it('says why it cannot run', async () => {
    const page = await harness.openShared('?bench&size=64');
    await start(page);
    await waitForState(page, 'failed');
    expect(await textOf(page, 'failure')).toContain('size is 64; write width and height in pixels');
    await page.goto(`${harness.server.url}?bench&scene=still-live`);
    await start(page);
    await waitForState(page, 'failed');
    expect(await textOf(page, 'failure')).toContain(
      'There is no built-in scene “still-live”; there are still-life',
    );
  });

  it('measures a fixed path of a file that its address names', async () => {
    const page = await harness.openShared('?bench&src=scene.ply&size=640x480&frames=2&accuracy=fast');
    // A link starts nothing, and what it asks for can be changed.
    await waitForState(page, 'ready');
    expect(await page.getByTestId('options').textContent()).toContain('Scene: scene.ply');
    await page.getByLabel('Size, px').fill('16x16');
    await start(page);
    expect(page.url()).toContain('size=16x16');
    await waitForState(page, 'done');
    expect(await textOf(page, 'facts')).toContain(`scene.ply, ${testScene().count} splats`);
  });

  it('gives a report to compare with others, and is cancelled', async () => {
    const page = await harness.newPage();
    const copied = await catchCopies(page);
    const scene = 'scene=hard:scale-unit&size=32x24&frames=3&accuracy=fast,sortKeyBits:32,rasterizer:quads';
    await page.goto(`${harness.server.url}?bench&${scene}`);
    await start(page);
    await waitForState(page, 'done');
    expect(await textOf(page, 'times')).toContain('Of 3 frames');
    expect(await textOf(page, 'facts')).toContain(
      '32×24 px, fast,sortKeyBits:32,rasterizer:quads, drawn by quads',
    );
    expect(await textOf(page, 'facts')).toContain('3 frames over 15°');
    await copy(page, 'JSON');
    await expect.poll(copied).toContain('"measurement"');
    expect(JSON.parse(await copied())).toMatchObject({
      scene: 'scale-unit',
      orbitDegrees: 15,
      measurement: {
        settings: { sortKeyBits: 32, rasterizer: 'quads' },
        widthPx: 32,
        heightPx: 24,
        frames: 3,
        wallClockMs: { median: expect.any(Number) },
      },
    });
    const saved = page.waitForEvent('download');
    await page.getByRole('button', { name: 'Save JSON' }).click();
    expect((await saved).suggestedFilename()).toMatch(/^websplatter-bench-scale-unit-.*\.json$/);

    const reports = page.getByTestId('reports');
    const report = { name: 'a.json', mimeType: 'application/json', buffer: Buffer.from(await copied()) };
    await reports.setInputFiles(report);
    await expect.poll(() => page.getByTestId('compared').getByRole('row').count()).toBeGreaterThan(1);
    await reports.setInputFiles({ ...report, buffer: Buffer.from('{}') });
    await page.getByRole('status').getByText('a.json is not a report of this benchmark.').waitFor();

    await clickInTurn(page, 'start', 'cancel');
    await waitForState(page, 'cancelled');
  });
});

interface RecordedRun {
  readonly machine: string;
  readonly adapter: string;
  readonly browser: string;
  readonly commit: string;
}

/** What the page shows of a file in `evidence/`. */
interface Recorded {
  readonly title: string;
  readonly conclusion: string;
  readonly run: RecordedRun;
  /** Instead of `run`, where there were several. */
  readonly runs?: readonly RecordedRun[];
  readonly tables: readonly { readonly rows: readonly (readonly (string | number | null)[])[] }[];
}

describe('the page of other renderers', () => {
  it('shows what the evidence has recorded, where and when, as that of another machine', async () => {
    const page = await harness.openShared('?peers');
    await page.getByText('not on this device').waitFor();
    for (const name of ['web-renderers', 'web-renderers-of-the-paper']) {
      const evidence: Recorded = JSON.parse(
        await readFile(new URL(`../evidence/${name}.json`, import.meta.url), 'utf8'),
      );
      const recorded = page.getByRole('region', { name: evidence.title, exact: true });
      await recorded.getByText(evidence.conclusion).waitFor();
      for (const run of evidence.runs ?? [evidence.run])
        await recorded
          .getByText(`${run.machine}; adapter ${run.adapter}; ${run.browser}`)
          .getByText(run.commit)
          .waitFor();
      const rows = await recorded.getByRole('row').count();
      expect(rows).toBe(evidence.tables.reduce((sum, table) => sum + 1 + table.rows.length, 0));
      const row = evidence.tables[0].rows[4];
      for (const cell of row.filter((each) => each !== null))
        expect(await recorded.getByRole('row').nth(5).textContent()).toContain(cell.toLocaleString('en'));
    }
  });

  it('shows the tables of a report, and refuses what is none', async () => {
    const page = await harness.openShared('?peers');
    const reports = page.getByTestId('reports');
    const file = (json: unknown) => ({
      name: 'peers.json',
      mimeType: 'application/json',
      buffer: Buffer.from(JSON.stringify(json)),
    });
    await reports.setInputFiles(file({}));
    await page.getByRole('status').getByText('peers.json is not a report of other renderers.').waitFor();
    await reports.setInputFiles(file(PEERS_REPORT));
    const part = page.getByTestId('part');
    await part.getByRole('row').getByText('websplatter').waitFor();
    expect(await part.textContent()).toContain('12.50 / 15.00');
    expect(await part.textContent()).toContain('websplatter: webgpu, balanced');
  });
});

/** As `npm run bench:peers -- --json` writes it, of one peer. */
const PEERS_REPORT = {
  date: '2026-01-02T03:04:05.678Z',
  command: 'npm run bench:peers',
  commit: null,
  machine: 'a machine',
  browser: 'a browser',
  adapter: null,
  wait: 'done',
  isFromFile: false,
  isLoads: false,
  widthPx: 64,
  heightPx: 48,
  pictureWidthPx: 64,
  pictureHeightPx: 48,
  frames: 2,
  jumps: 2,
  scenes: [
    {
      scene: 'garden',
      format: { name: 'ply', variant: '' },
      fileBytes: 1e6,
      splats: 1000,
      shDegree: 3,
      rows: [
        {
          peer: 'websplatter',
          isFloor: false,
          version: null,
          isReader: true,
          pictures: [{ camera: 'front', psnrDb: 50 }],
          failures: [],
          rounds: [
            {
              round: 0,
              loaded: { loadMs: 9, firstSplatsMs: 9, longestTaskMs: 0, api: 'webgpu', note: 'balanced' },
              measured: { turnMs: [1, 2], orders: null, correctMs: [10, 15], gpuMs: [] },
              state: { gpuBytes: 1e6, gpuPeakBytes: 2e6, adapter: null, figures: {}, problems: [] },
              heap: { jsBytes: 1e6 },
            },
          ],
        },
      ],
    },
  ],
};

describe('the pages of the lab', () => {
  it('lead to the licences of the packages in them', async () => {
    const page = await harness.openShared('');
    await page.getByRole('link', { name: 'Licences' }).click();
    await page.getByText('react-dom').first().waitFor();
    const text = await page.textContent('body');
    for (const words of ['scheduler', 'MIT', 'THE SOFTWARE IS PROVIDED "AS IS"'])
      expect(text).toContain(words);
  });

  it.each([
    ['the first page', '', 'h1'],
    ['the gallery', '?gallery&q=truncated', '[data-testid=gallery]'],
    ['a hard case', '?gallery&case=scale-zero-all', '[data-testid=case-legend]'],
    ['a refused file', '?gallery&case=input-truncated', '[data-testid=case-refusal] dd:last-child code'],
    ['the hard cases', '?conformance&cases=scale-unti', '[data-testid=failure]'],
    ['the benchmark', '?bench&size=9', '[data-testid=start]'],
    ['other renderers', '?peers', 'h1'],
  ])('have nothing that axe-core finds wrong: %s', async (name, address, selector) => {
    const page = await harness.openShared(address);
    await page.locator(selector).waitFor();
    await page.evaluate(AXE);
    await expectAccessible(page, name);
  });
});
