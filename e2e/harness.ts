import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect } from 'vitest';
import { DEFAULT_VIEWPORT, launchBrowser, newWatchedPage, type WatchedPage, watchPage } from './browser.ts';
import { type AppServer, type ServedFiles, startAppServer } from './server.ts';

/** All that tests may leave, without caches of compiled shaders and scripts. */
const STORAGE = 'cookies,file_systems,indexeddb,local_storage,service_workers,cache_storage,storage_buckets';

export interface Harness {
  readonly browser: Browser;
  readonly server: AppServer;
  /** Opens a blank page. */
  newPage(options?: BrowserContextOptions): Promise<Page>;
  /** Opens a blank page in another tab beside a page: as large, with the same storage. */
  newTab(beside: Page): Promise<Page>;
  /** Opens a page at `address`, e.g. `?scene=still-life-small`, without waiting for its content. */
  open(address: string, options?: BrowserContextOptions): Promise<Page>;
  /**
   * The page of a window that all tests with these `options` share, whatever their viewports, which is
   * quicker than a window of their own. Nothing of the test before is left once it loads an address:
   * its storage, scripts and routes are new. Tests that listen to a page longer than they last take
   * `newPage`, as do those that end its renderer.
   *
   * @param scripts run in the page before its own, for this test alone.
   */
  sharedPage(options?: BrowserContextOptions, scripts?: readonly (() => void)[]): Promise<Page>;
  /** Loads `address` in the shared page, without waiting for its content. */
  openShared(address: string, options?: BrowserContextOptions): Promise<Page>;
  /** Expects a warning or error that matches `pattern` from the pages of this test. */
  expectProblem(pattern: RegExp): void;
}

/**
 * Starts a browser, and a server of the app in `appFolder` (relative to the repository's root; see
 * `startAppServer`), for the tests of a file. A test fails if its pages log warnings or errors.
 *
 * @param initScript runs in each page before the page's own scripts.
 */
export function appHarness(
  appFolder: string,
  files: ServedFiles = {},
  initScript: (() => void) | null = null,
): Harness {
  let browser: Browser;
  let server: AppServer;
  let watchedPages: WatchedPage[] = [];
  let tabs: WatchedPage[] = [];
  let expectedProblems: RegExp[] = [];
  const sharedPages = new Map<string, WatchedPage & { problemsSeen: number }>();
  /** Scripts that this test has added to shared pages. */
  let scriptsOfTest: { dispose(): Promise<void> }[] = [];

  beforeAll(async () => {
    [browser, server] = await Promise.all([launchBrowser(), startAppServer(appFolder, files)]);
  });

  afterAll(async () => {
    await browser?.close();
    await server?.close();
  });

  afterEach(async ({ task }) => {
    const hasFailed = task.result?.state === 'fail';
    for (const { page } of tabs) await page.close();
    const watched = [...watchedPages, ...tabs];
    const contexts = new Set(watchedPages.map(({ page }) => page.context()));
    const expected = expectedProblems;
    [watchedPages, tabs, expectedProblems] = [[], [], []];
    for (const context of contexts) await context.close();
    if (!hasFailed) for (const { page } of sharedPages.values()) await leave(page);
    // A page that is closed has no scripts.
    for (const script of scriptsOfTest) await script.dispose().catch(() => {});
    scriptsOfTest = [];
    const problems = watched.flatMap((each) => each.problems);
    for (const shared of sharedPages.values()) {
      problems.push(...shared.problems.slice(shared.problemsSeen));
      shared.problemsSeen = shared.problems.length;
    }
    const unexpected = problems.filter((problem) => !expected.some((pattern) => pattern.test(problem)));
    if (hasFailed || unexpected.length > 0) {
      for (const { page } of sharedPages.values()) await page.context().close();
      sharedPages.clear();
    }
    expect(unexpected, 'what the page complained about').toEqual([]);
    for (const pattern of expected)
      expect(problems.join('\n'), 'what the page complained about').toMatch(pattern);
  });

  /** Ends what a test has done in a shared page. */
  const leave = async (page: Page): Promise<void> => {
    if (page.url() === 'about:blank') return;
    // A page that crashed has told so itself, here and below.
    await page.unrouteAll({ behavior: 'ignoreErrors' }).catch(() => {});
    // Clearing the storage of an origin spares it.
    await page.evaluate(() => sessionStorage.clear()).catch(() => {});
    // The page's later complaints would fall to the next test.
    await page.goto('about:blank').catch(() => {});
    // Beside the page, as before a test has moved it.
    await page.mouse.move(-1, -1).catch(() => {});
  };

  const newTab = async (beside: Page) => {
    const tab = watchPage(await beside.context().newPage());
    tabs.push(tab);
    await tab.page.setViewportSize(beside.viewportSize()!);
    return tab.page;
  };
  const newWatched = async (options: BrowserContextOptions) => {
    const watched = await newWatchedPage(browser, options);
    // Also in tabs that the page opens.
    if (initScript) await watched.page.context().addInitScript(initScript);
    return watched;
  };
  const newPage = async (options: BrowserContextOptions = {}) => {
    const watched = await newWatched(options);
    watchedPages.push(watched);
    return watched.page;
  };
  const sharedPage: Harness['sharedPage'] = async ({ viewport, ...options } = {}, scripts = []) => {
    const key = JSON.stringify(options);
    const shared = sharedPages.get(key) ?? { ...(await newWatched(options)), problemsSeen: 0 };
    sharedPages.set(key, shared);
    const { page } = shared;
    const session = await page.context().newCDPSession(page);
    await session.send('Storage.clearDataForOrigin', {
      origin: new URL(server.url).origin,
      storageTypes: STORAGE,
    });
    await session.detach();
    // A test before may have changed it.
    await page.setViewportSize(viewport ?? DEFAULT_VIEWPORT);
    for (const script of scripts) scriptsOfTest.push(await page.addInitScript(script));
    return page;
  };
  return {
    get browser() {
      return browser;
    },
    get server() {
      return server;
    },
    newPage,
    newTab,
    open: async (address, options) => {
      const page = await newPage(options);
      await page.goto(`${server.url}${address}`);
      return page;
    },
    sharedPage,
    openShared: async (address, options) => {
      const page = await sharedPage(options);
      await page.goto(`${server.url}${address}`);
      return page;
    },
    expectProblem: (pattern) => {
      expectedProblems.push(pattern);
    },
  };
}
