import { existsSync, realpathSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { type Browser, type BrowserContextOptions, chromium, type Page } from 'playwright-core';

const executablePath = process.env.CHROMIUM_PATH ?? '/usr/bin/chromium';

/** `WEBSPLATTER_BROWSER_GPU=1` runs the tests on this machine's GPU; by default they run on the CPU, alike everywhere. */
const usesGpu = process.env.WEBSPLATTER_BROWSER_GPU === '1';

const COMMON_ARGS = [
  '--headless=new',
  '--no-sandbox',
  '--enable-unsafe-webgpu',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--use-angle=vulkan',
  // Without it Chromium 156 finds no shared image that both WebGPU and the compositor can use.
  '--enable-features=Vulkan',
];

/** WebGPU and canvases on SwiftShader: unless canvases use Vulkan too, the first `getCurrentTexture` ends WebGPU. */
const SWIFTSHADER_ARGS = [
  '--use-webgpu-adapter=swiftshader',
  '--use-gl=angle',
  '--use-vulkan=swiftshader',
  // SwiftShader takes most of a second to compile a shader that zeroes 16 KiB of workgroup memory in this way.
  '--disable-dawn-features=use_vulkan_zero_initialize_workgroup_memory_extension',
];

/** Without a display there is no Vulkan surface, and the sandbox of the GPU process hides the driver's files. */
const GPU_ARGS = [
  '--use-webgpu-adapter=default',
  '--ignore-gpu-blocklist',
  '--disable-gpu-sandbox',
  '--disable-vulkan-surface',
];

/**
 * ANGLE asks the system's Vulkan loader for a driver, whatever --use-vulkan says. Without a GPU the only driver is Chromium's
 * SwiftShader, which the loader finds through this variable alone.
 */
function vulkanEnvironment(): Record<string, string> {
  const folders = [dirname(realpathSync(executablePath)), '/usr/lib/chromium'];
  const driver = folders.map((folder) => join(folder, 'vk_swiftshader_icd.json')).find(existsSync);
  return driver ? { VK_ICD_FILENAMES: driver, VK_DRIVER_FILES: driver } : {};
}

export function launchBrowser(): Promise<Browser> {
  const env = { ...process.env, ...(!usesGpu && vulkanEnvironment()) } as Record<string, string>;
  return chromium.launch({
    executablePath,
    args: [...COMMON_ARGS, ...(usesGpu ? GPU_ARGS : SWIFTSHADER_ARGS)],
    // Playwright disables the GPU if there is no display.
    ignoreDefaultArgs: usesGpu ? ['--disable-gpu', '--disable-software-rasterizer'] : [],
    env,
  });
}

/** A page with its warnings and errors, of which a passing test must have none. */
export interface WatchedPage {
  readonly page: Page;
  readonly problems: readonly string[];
}

/** Chrome reports some WebGPU failures as warnings only. */
const WEBGPU_WARNING = /webgpu|\bGPU|Instance reference|WGSL/i;
/** @react-three/fiber 9 always requests a kind of shadow that three no longer has. */
const WARNING_OF_FIBER = /^THREE\.WebGPURenderer: PCFSoftShadowMap has been removed/;

export async function newWatchedPage(browser: Browser, options: BrowserContextOptions): Promise<WatchedPage> {
  const context = await browser.newContext({
    viewport: { width: 480, height: 320 },
    // With smooth steps the number of frames would depend on the machine's speed.
    reducedMotion: 'reduce',
    ...options,
  });
  const page = await context.newPage();
  const problems: string[] = [];
  page.on('pageerror', (error) => problems.push(`page error: ${error.stack ?? error.message}`));
  page.on('crash', () => problems.push('the page crashed'));
  page.on('console', (message) => {
    const text = message.text();
    const isWarning =
      message.type() === 'warning' && WEBGPU_WARNING.test(text) && !WARNING_OF_FIBER.test(text);
    if (message.type() === 'error' || isWarning) problems.push(`console ${message.type()}: ${text}`);
  });
  return { page, problems };
}
