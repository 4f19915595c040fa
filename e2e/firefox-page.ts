import { type Browser, launchFirefox, type Page } from '@websplatter/tools/firefox';
import { LONG_PATIENCE_MS } from '@websplatter/tools/patience';
import { consoleProblem } from './browser.ts';
import { decodePng } from './png.ts';
import type { Screenshot } from './screenshot.ts';
import { firefox, lavapipe } from './second-webgpu.ts';

/** A page in Firefox with its errors and WebGPU warnings: a passing test has none. */
export interface FirefoxPage {
  readonly page: Page;
  readonly problems: readonly string[];
}

export function launch(downloadFolder: string): Promise<Browser> {
  return launchFirefox({ executablePath: firefox, driverFile: lavapipe, downloadFolder });
}

/**
 * Opens a page at `url`. Firefox reports neither WebGPU's errors that no scope has caught nor lost
 * devices, so the page itself does.
 *
 * @param scripts run in the page before its own.
 */
export async function openPage(
  browser: Browser,
  url: string,
  scripts: readonly (() => void)[] = [],
): Promise<FirefoxPage> {
  const page = await browser.newPage();
  page.setDefaultTimeout(LONG_PATIENCE_MS);
  const problems: string[] = [];
  page.on('pageerror', (error) => problems.push(`page error: ${error}`));
  page.on('console', (message) => {
    const problem = consoleProblem(message.type(), message.text());
    if (problem !== null) problems.push(problem);
  });
  await page.setViewport({ width: 240, height: 160 });
  for (const script of [reportGpuErrors, ...scripts]) await page.evaluateOnNewDocument(script);
  await page.goto(url);
  return { page, problems };
}

function reportGpuErrors(): void {
  if (!('GPUAdapter' in window)) return;
  const { requestDevice } = GPUAdapter.prototype;
  GPUAdapter.prototype.requestDevice = async function (...options) {
    const device = await requestDevice.apply(this, options);
    device.addEventListener('uncapturederror', ({ error }) => console.error(`WebGPU: ${error.message}`));
    void device.lost.then(({ reason, message }) => {
      if (reason !== 'destroyed') console.error(`WebGPU: the device was lost: ${message}`);
    });
    return device;
  };
}

/** Adds CSS to the page, as a strict content security policy allows. */
export function adoptStyle(page: Page, css: string): Promise<void> {
  return page.evaluate((text) => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(text);
    document.adoptedStyleSheets.push(sheet);
  }, css);
}

/** Captures an element as shown on the screen. */
export async function screenshotOf(page: Page, selector: string): Promise<Screenshot> {
  const element = await page.$(selector);
  if (!element) throw new Error(`The page has no ${selector}.`);
  return decodePng(await element.screenshot());
}
