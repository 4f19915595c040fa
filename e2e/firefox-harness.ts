import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Browser, Page } from '@websplatter/tools/firefox';
import { afterAll, afterEach, beforeAll, expect, type test } from 'vitest';
import { type FirefoxPage, launch, openPage } from './firefox-page.ts';
import { firefox, lavapipe, puppeteer, testWith } from './second-webgpu.ts';
import { type AppServer, type ServedFiles, startAppServer } from './server.ts';
import { loseDeviceOnDemand, noteViewer } from './viewer-page.ts';

export interface FirefoxHarness {
  /** `test` where Firefox can be driven, and skipped elsewhere. */
  readonly firefoxTest: typeof test | typeof test.skip;
  /** For files of the tests, until they are over; pages save theirs there. */
  readonly folder: string;
  /** Serves an app with `files` from a place of its own, and opens its page at `address`. */
  open(appFolder: string, address: string, files: ServedFiles): Promise<Page>;
  openAt(url: string): Promise<Page>;
}

/** Starts one Firefox for the tests of a file. A test fails if its pages log warnings or errors. */
export function firefoxHarness(): FirefoxHarness {
  const firefoxTest = testWith({
    Firefox: firefox,
    'lavapipe (mesa-vulkan-drivers)': lavapipe,
    'puppeteer-core': puppeteer,
  });
  const servers: AppServer[] = [];
  let browser: Browser | undefined;
  let folder: string;
  let watched: FirefoxPage[] = [];
  beforeAll(async () => {
    folder = await mkdtemp(join(tmpdir(), 'websplatter-firefox-'));
    if (firefox && lavapipe && puppeteer) browser = await launch(folder);
  });
  afterEach(async () => {
    const pages = watched;
    watched = [];
    for (const { page } of pages) await page.close();
    expect(
      pages.flatMap(({ problems }) => problems),
      'what the page complained about',
    ).toEqual([]);
  });
  afterAll(async () => {
    await browser?.close();
    for (const server of servers) await server.close();
    await rm(folder, { recursive: true, force: true });
  });
  const openAt = async (url: string) => {
    const opened = await openPage(browser!, url, [loseDeviceOnDemand, noteViewer]);
    watched.push(opened);
    return opened.page;
  };
  return {
    firefoxTest,
    get folder() {
      return folder;
    },
    open: async (appFolder, address, files) => {
      const server = await startAppServer(appFolder, files);
      servers.push(server);
      return openAt(`${server.url}${address}`);
    },
    openAt,
  };
}
