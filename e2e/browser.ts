import { launchBrowser as launch } from '@websplatter/tools/browser';
import { PATIENCE_MS } from '@websplatter/tools/patience';
import type { Browser, BrowserContextOptions, Page } from 'playwright-core';
import { withResolvers } from './with-resolvers.ts';

/** `WEBSPLATTER_BROWSER_GPU=1` tests on this machine's GPU; the default is the CPU. */
export const USES_GPU = process.env.WEBSPLATTER_BROWSER_GPU === '1';

export function launchBrowser(): Promise<Browser> {
  return launch({
    executablePath: process.env.CHROMIUM_PATH ?? '/usr/bin/chromium',
    usesGpu: USES_GPU,
  });
}

/** A page with its warnings and errors: any of them fails the test. */
export interface WatchedPage {
  readonly page: Page;
  readonly problems: readonly string[];
}

/** Browsers report some WebGPU failures as warnings only. */
const WEBGPU_WARNING = /webgpu|\bGPU|Instance reference|WGSL/i;
/** @react-three/fiber 9 always requests a kind of shadow that three no longer has. */
const WARNING_OF_FIBER = /^THREE\.WebGPURenderer: PCFSoftShadowMap has been removed/;

/** The fault in a console message; null for harmless ones. `type`: the browser driver's word. */
export function consoleProblem(type: string, text: string): string | null {
  const isWarning = type.startsWith('warn') && WEBGPU_WARNING.test(text) && !WARNING_OF_FIBER.test(text);
  return type === 'error' || isWarning ? `console ${type}: ${text}` : null;
}

/** Delays a page's requests for URLs that match `pattern` until the returned function is called. */
export async function holdRequests(page: Page, pattern: string): Promise<() => void> {
  const { promise: released, resolve: release } = withResolvers();
  await page.route(pattern, async (route) => {
    await released;
    await route.continue();
  });
  return release;
}

export const DEFAULT_VIEWPORT = { width: 480, height: 320 };

export async function newWatchedPage(browser: Browser, options: BrowserContextOptions): Promise<WatchedPage> {
  const context = await browser.newContext({
    viewport: DEFAULT_VIEWPORT,
    // With smooth steps the number of frames would depend on the machine's speed.
    reducedMotion: 'reduce',
    ...options,
  });
  context.setDefaultTimeout(PATIENCE_MS);
  return watchPage(await context.newPage());
}

export function watchPage(page: Page): WatchedPage {
  const problems: string[] = [];
  page.on('pageerror', (error) => problems.push(`page error: ${error.stack ?? error.message}`));
  page.on('crash', () => problems.push('the page crashed'));
  page.on('console', (message) => {
    const problem = consoleProblem(message.type(), message.text());
    if (problem !== null) problems.push(problem);
  });
  return { page, problems };
}
