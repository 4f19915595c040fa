import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect } from 'vitest';
import { launchBrowser, newWatchedPage, type WatchedPage } from './browser.ts';
import { startViewerServer, type ViewerServer } from './server.ts';
import { waitForPicture } from './viewer-page.ts';

export interface Harness {
  readonly server: ViewerServer;
  /** A page that has not gone anywhere yet. */
  newPage(options?: BrowserContextOptions): Promise<Page>;
  /** A page at the viewer's `address`, e.g. `?scene=still-life-small`, with its first picture on the screen. */
  openViewer(address?: string, options?: BrowserContextOptions): Promise<Page>;
}

/** A browser and a server for the tests of a file; each test's page must have nothing to complain about. */
export function viewerHarness(): Harness {
  let browser: Browser;
  let server: ViewerServer;
  let watched: WatchedPage | null = null;

  beforeAll(async () => {
    [browser, server] = await Promise.all([launchBrowser(), startViewerServer()]);
  });

  afterAll(async () => {
    await browser?.close();
    await server?.close();
  });

  afterEach(async () => {
    const { page, problems } = watched ?? { page: null, problems: [] };
    watched = null;
    await page?.context().close();
    expect(problems, 'what the page complained about').toEqual([]);
  });

  const newPage = async (options: BrowserContextOptions = {}) => {
    watched = await newWatchedPage(browser, options);
    return watched.page;
  };
  return {
    get server() {
      return server;
    },
    newPage,
    openViewer: async (address = '?scene=still-life-small', options = {}) => {
      const page = await newPage(options);
      await page.goto(`${server.url}${address}`);
      await waitForPicture(page);
      return page;
    },
  };
}
