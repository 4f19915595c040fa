import { createRequire } from 'node:module';
import type { Browser } from 'puppeteer-core';
import { environmentWith } from './vulkan.ts';

export type { Browser, Page } from 'puppeteer-core';

/** Path of the driver of Firefox; undefined if npm has not installed it. */
export function findPuppeteer(): string | undefined {
  try {
    return createRequire(import.meta.url).resolve('puppeteer-core');
  } catch {
    // npm has not installed it: its callers skip, and say so.
    return undefined;
  }
}

export interface FirefoxOptions {
  /** Path of Firefox's executable. */
  readonly executablePath: string;
  /** Description (ICD) of the Vulkan driver that WebGPU uses. */
  readonly driverFile: string;
  /** Folder for downloads, which are saved without asking. */
  readonly downloadFolder?: string;
}

/** Starts a headless Firefox with WebGPU on one Vulkan driver, driven by WebDriver BiDi. */
export async function launchFirefox({
  executablePath,
  driverFile,
  downloadFolder,
}: FirefoxOptions): Promise<Browser> {
  // Imported on demand: skipped tests need no installation of it.
  const { launch } = await import('puppeteer-core');
  return launch({
    browser: 'firefox',
    executablePath,
    headless: true,
    // Tests have their own timeouts, and hard cases take minutes.
    protocolTimeout: 0,
    env: environmentWith(driverFile),
    extraPrefsFirefox: {
      'dom.webgpu.enabled': true,
      // CPU drivers are on the blocklist.
      'gfx.webgpu.ignore-blocklist': true,
      // With smooth steps, the number of frames would depend on the machine's speed.
      'ui.prefersReducedMotion': 1,
      ...(downloadFolder && { 'browser.download.folderList': 2, 'browser.download.dir': downloadFolder }),
    },
  });
}
