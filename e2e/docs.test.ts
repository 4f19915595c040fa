// Proves: the built site: search, examples that run, axe-core, no third party.
import { execFile } from 'node:child_process';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { type FileServer, serveFiles } from '@websplatter/tools/file-server';
import { LONG_PATIENCE_MS } from '@websplatter/tools/patience';
import type { AxeResults } from 'axe-core';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { AXE } from './accessible.ts';
import { launchBrowser, newWatchedPage, type WatchedPage } from './browser.ts';
import { screenshot } from './screenshot.ts';
import { slowDisplay } from './slow-display.ts';

const repositoryRoot = fileURLToPath(new URL('..', import.meta.url));
const BASE = '/some/where/';
const PHONE = { width: 390, height: 844 };
const TABLET = { width: 800, height: 1000 };
const DESKTOP = { width: 1280, height: 800 };
/** Software draws the stage of an example in it quickly. */
const SMALL = { width: 480, height: 360 };
/** A page of each kind. */
const KINDS = [
  'index.html',
  'guides/loading.html',
  'shipping/performance.html',
  'examples/index.html',
  'examples/picking.html',
  'api/core/index.html',
  'api/core/interfaces/FrameRequest.html',
  'hood/accuracy.html',
  '404.html',
];

/** Rules of axe-core that read colours. */
const COLOR_RULES = ['color-contrast', 'link-in-text-block'];

/** Ends a build that hangs: on a busy machine, it has taken longer than a test may. */
const BUILD_TIMEOUT_MS = 1_800_000;

let folder: string;
let host: FileServer;
let browser: Browser;

// The build takes a minute of processor time; the short run tests the site's pages below apps/docs.
describe('the documentation site', () => {
  beforeAll(async () => {
    folder = await mkdtemp(join(tmpdir(), 'websplatter-docs-'));
    const build = join(repositoryRoot, 'apps/docs/build.mjs');
    // NODE_ENV and the export conditions of Vitest's process change the build.
    const { NODE_ENV: _, NODE_OPTIONS: __, ...env } = process.env;
    // It ends with an error where a link or an anchor of a built page leads nowhere.
    await promisify(execFile)(process.execPath, [build, '--base', BASE, '--out', folder], { env });
    host = await serveFiles(folder, { base: BASE });
    browser = await launchBrowser();
  }, BUILD_TIMEOUT_MS);

  afterAll(async () => {
    await browser?.close();
    await host?.close();
    if (folder) await rm(folder, { recursive: true, force: true });
  });

  it.each(KINDS)(
    '%s asks no other server, and passes axe-core, light and dark, in windows of any size',
    async (path) => {
      const { page, problems } = await open('about:blank');
      const elsewhere: string[] = [];
      page.on('request', (request) => {
        if (!request.url().startsWith(host.url) && !/^(?:blob|data):/.test(request.url()))
          elsewhere.push(request.url());
      });
      await page.goto(host.url + path, { waitUntil: 'networkidle' });
      // The page of lost addresses has nothing in it until its script has run.
      await page.getByRole('main').first().waitFor();
      await page.evaluate(AXE);
      for (const colorScheme of ['light', 'dark'] as const) {
        await page.emulateMedia({ colorScheme });
        await page.locator(colorScheme === 'dark' ? 'html.dark' : 'html:not(.dark)').waitFor();
        for (const viewport of [PHONE, TABLET, DESKTOP]) {
          await page.setViewportSize(viewport);
          await expect
            .poll(() => page.evaluate(() => document.documentElement.scrollWidth - innerWidth), {
              message: `${path} is wider than ${viewport.width} px`,
            })
            .toBeLessThanOrEqual(0);
          // Rules that read no colours have the same to say in the dark.
          const rules = colorScheme === 'dark' ? COLOR_RULES : null;
          expect(await violations(page, rules), `${colorScheme}, ${viewport.width} px`).toEqual([]);
        }
      }
      expect(elsewhere).toEqual([]);
      expect(problems).toEqual([]);
      await page.context().close();
    },
  );

  it('finds pages by the words that one types, with the keyboard alone', async () => {
    const { page, problems } = await open('guides/loading.html');
    await openSearch(page);
    await page.keyboard.type('depth of field');
    await page.locator('.VPLocalSearchBox .result').first().waitFor();
    await page.keyboard.press('Enter');
    await page.waitForURL((url) => !url.pathname.endsWith('guides/loading.html'));
    expect(problems).toEqual([]);
    await page.context().close();
  });

  describe('has a search that', () => {
    let page: Page;

    beforeAll(async () => {
      ({ page } = await open('guides/loading.html'));
    });

    afterAll(() => page?.context().close());

    it.each([
      ['getting started', /\/learn\/quick-start\.html/, 1],
      ['black screen', /\/learn\/troubleshooting\.html/, 1],
      ['lod', /\/guides\/level-of-detail\.html/, 1],
      ['streaming', /\/guides\/streaming\.html/, 1],
      ['crop', /\/guides\/(?:saving|effects)\.html/, 1],
      ['spz', /\/(?:hood\/formats|learn\/get-a-scene)\.html/, 1],
      ['screenshot', /\/guides\/saving\.html/, 1],
      ['upside down', /\/learn\/camera\.html/, 1],
      ['next', /\/shipping\/next\.html/, 1],
      ['nextjs', /\/shipping\/next\.html/, 1],
      ['opacity', /\/(?:guides\/effects|api\/react\/interfaces\/SplatsProps)\.html/, 1],
      ['memory', /\/shipping\/(?:errors|performance)\.html/, 1],
      ['cors', /\/(?:shipping\/hosting|learn\/troubleshooting)\.html/, 1],
      ['mobile', /\/learn\/troubleshooting\.html/, 1],
      ['shadows', /\/guides\/(?:shadows|depth)\.html/, 1],
      ['performance', /\/shipping\/performance\.html/, 1],
      ['createView', /\/api\/core\/interfaces\/SplatEngine\.html/, 3],
      ['threejs', /./, 1],
    ])('finds “%s” where readers look for it', async (words, address, places) => {
      await openSearch(page);
      const results = page.locator('.VPLocalSearchBox .result');
      // What the test before has found goes first.
      await page.keyboard.press('Control+a');
      await page.keyboard.press('Delete');
      await expect.poll(() => results.count()).toBe(0);
      await page.keyboard.type(words);
      const found = () => results.evaluateAll((links) => links.map((link) => link.getAttribute('href')));
      await expect
        .poll(async () => (await found()).slice(0, places))
        .toContainEqual(expect.stringMatching(address));
    });
  });

  it('names what functions take apart by its type', async () => {
    const { page } = await open('api/react/functions/Splats.html');
    expect(await page.getByRole('main').innerText()).toContain('function Splats(props): ReactNode;');
    await page.context().close();
  });

  it('draws an example, which is edited, and runs again by Ctrl+Enter', async () => {
    const { page, problems } = await openExample('plain-engine');
    const poster = page.locator('.ws-poster');
    await poster.waitFor();
    await running(page);
    await poster.waitFor({ state: 'hidden' });
    await expect.poll(() => colorsOf(page)).toBeGreaterThan(1000);
    await edit(page, 'document.body.style.background = "rgb(250, 0, 0)";');
    await page.keyboard.press('Control+Enter');
    await running(page);
    await expect
      .poll(() => frameOf(page).evaluate(() => document.body.style.background))
      .toBe('rgb(250, 0, 0)');
    await page.getByRole('button', { name: 'Reset' }).click();
    await expect.poll(() => frameOf(page).locator('canvas').count()).toBe(1);
    expect(problems).toEqual([]);
    await page.context().close();
  });

  it('mounts an example’s component of React', async () => {
    const { page, problems } = await openExample('first-splat');
    await running(page);
    await expect.poll(() => frameOf(page).locator('canvas').count()).toBe(1);
    expect(problems).toEqual([]);
    await page.context().close();
  });

  it('tells what is wrong with an example’s source, in which line, and what it may not reach', async () => {
    const { page } = await openExample('plain-engine');
    await running(page);
    const problem = page.getByRole('alert');
    for (const [source, message, line] of [
      ['const a = 1;\nconst b = ;', 'Unexpected token', 2],
      ['\n\nthrow new RangeError("too far");', 'RangeError: too far', 3],
      // Neither the page around it, nor the server.
      ['document.title = parent.document.title;', 'SecurityError', null],
      ['await fetch("../index.html");', 'Failed to fetch', null],
    ] as const) {
      await edit(page, source);
      await page.keyboard.press('Control+Enter');
      await problem.getByText(message).waitFor();
      if (line !== null)
        expect(await page.getByRole('button', { name: `plain-engine.ts, line ${line}` }).isVisible()).toBe(
          true,
        );
    }
    await page.context().close();
  });

  it.each([
    ['hood/accuracy-here.html', 'PSNR (dB)', 5],
    ['shipping/performance.html', 'median ms', 2],
  ])('measures this device in %s, and copies the figures as text', async (path, column, leastRows) => {
    const { page, problems } = await open(path);
    await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
    await page.getByRole('button', { name: 'Measure here' }).click();
    await page.getByRole('columnheader', { name: column }).first().waitFor({ timeout: LONG_PATIENCE_MS });
    expect(await page.locator('ws-measure tbody tr').count()).toBeGreaterThanOrEqual(leastRows);
    await page.getByRole('button', { name: 'Copy as text' }).click();
    await page.getByRole('status').getByText('Copied.').waitFor();
    const text = await page.evaluate(() => navigator.clipboard.readText());
    expect(text).toMatch(/SwiftShader|GPU|software/i);
    expect(text).toContain(`| ${column} |`);
    expect(problems).toEqual([]);
    await page.context().close();
  });
});

async function open(path: string, viewport = DESKTOP): Promise<WatchedPage> {
  const watched = await newWatchedPage(browser, { viewport });
  await watched.page.addInitScript(slowDisplay);
  await watched.page.goto(new URL(path, host.url).href);
  return watched;
}

/** Opens the page of an example, which runs once it is in sight. */
async function openExample(name: string): Promise<WatchedPage> {
  const watched = await open(`examples/${name}.html`, SMALL);
  await watched.page.locator('ws-playground').scrollIntoViewIfNeeded();
  return watched;
}

async function violations(page: Page, rules: readonly string[] | null): Promise<string[]> {
  const { violations: found } = await page.evaluate((runOnly) => {
    const { axe } = window as unknown as { axe: { run: (options: object) => Promise<AxeResults> } };
    // Contents of examples are tested with them.
    return axe.run({ resultTypes: ['violations'], iframes: false, ...(runOnly && { runOnly }) });
  }, rules);
  return found.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join(' | ')}`);
}

const running = (page: Page) => page.locator('.ws-status').getByText('Running').waitFor();

function frameOf(page: Page) {
  return page.frames().find((frame) => frame !== page.mainFrame())!;
}

/** Replaces the source in the editor. */
async function edit(page: Page, text: string): Promise<void> {
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(text);
}

/** Number of different colours on the stage: one, as long as nothing is drawn. */
async function colorsOf(page: Page): Promise<number> {
  const { data } = await screenshot(page.locator('.ws-stage'));
  const pixels = new Uint32Array(data.buffer, data.byteOffset, data.byteLength / 4);
  return new Set(pixels).size;
}

async function openSearch(page: Page): Promise<void> {
  // The page may not listen to keys yet, and keys before the box is there go nowhere.
  const box = page.locator('.VPLocalSearchBox input:focus');
  await expect
    .poll(async () => {
      if ((await box.count()) === 0) await page.keyboard.press('Control+k');
      return box.count();
    })
    .toBe(1);
}
