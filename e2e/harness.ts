import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect } from 'vitest';
import { DEFAULT_VIEWPORT, launchBrowser, newWatchedPage, type WatchedPage } from './browser.ts';
import { type AppServer, type ServedFiles, startAppServer } from './server.ts';

export interface Harness {
  readonly browser: Browser;
  readonly server: AppServer;
  /** Opens a blank page. */
  newPage(options?: BrowserContextOptions): Promise<Page>;
  /** Opens a page at `address`, e.g. `?scene=still-life-small`, without waiting for its content. */
  open(address: string, options?: BrowserContextOptions): Promise<Page>;
  /**
   * Loads `address` in a window that all tests with these `options` share, which is quicker than a
   * window of their own. Nothing of the test before is left: the page is a new one, and so is its
   * storage. Tests that route requests, add scripts to pages, or listen to a page longer than they
   * last take `open`.
   */
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
  let expectedProblems: RegExp[] = [];
  const sharedPages = new Map<string, WatchedPage>();
  let problemsOfShared = 0;

  beforeAll(async () => {
    [browser, server] = await Promise.all([launchBrowser(), startAppServer(appFolder, files)]);
  });

  afterAll(async () => {
    await browser?.close();
    await server?.close();
  });

  afterEach(async ({ task }) => {
    const watched = watchedPages;
    const expected = expectedProblems;
    watchedPages = [];
    expectedProblems = [];
    for (const { page } of watched) await page.context().close();
    // A page's later complaints would fall to the next test. Crashed pages say so themselves.
    for (const { page } of sharedPages.values()) await page.goto('about:blank').catch(() => {});
    const ofShared = [...sharedPages.values()].flatMap((each) => each.problems);
    const problems = [...watched.flatMap((each) => each.problems), ...ofShared.slice(problemsOfShared)];
    problemsOfShared = ofShared.length;
    if (task.result?.state === 'fail' || problems.length > 0) {
      for (const { page } of sharedPages.values()) await page.context().close();
      sharedPages.clear();
      problemsOfShared = 0;
    }
    const unexpected = problems.filter((problem) => !expected.some((pattern) => pattern.test(problem)));
    expect(unexpected, 'what the page complained about').toEqual([]);
    for (const pattern of expected)
      expect(problems.join('\n'), 'what the page complained about').toMatch(pattern);
  });

  const newWatched = async (options: BrowserContextOptions): Promise<WatchedPage> => {
    const watched = await newWatchedPage(browser, options);
    if (initScript) await watched.page.addInitScript(initScript);
    return watched;
  };
  const newPage = async (options: BrowserContextOptions = {}) => {
    const watched = await newWatched(options);
    watchedPages.push(watched);
    return watched.page;
  };
  return {
    get browser() {
      return browser;
    },
    get server() {
      return server;
    },
    newPage,
    open: async (address, options) => {
      const page = await newPage(options);
      await page.goto(`${server.url}${address}`);
      return page;
    },
    openShared: async (address, options = {}) => {
      const key = JSON.stringify(options);
      const shared = sharedPages.get(key) ?? (await newWatched(options));
      sharedPages.set(key, shared);
      const { page } = shared;
      const session = await page.context().newCDPSession(page);
      await session.send('Storage.clearDataForOrigin', {
        origin: new URL(server.url).origin,
        storageTypes: 'all',
      });
      await session.detach();
      // A test before may have changed it.
      await page.setViewportSize(options.viewport ?? DEFAULT_VIEWPORT);
      await page.goto(`${server.url}${address}`);
      return page;
    },
    expectProblem: (pattern) => {
      expectedProblems.push(pattern);
    },
  };
}
