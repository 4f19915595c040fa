import { existsSync, realpathSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { type Browser, chromium } from 'playwright-core';

export interface BrowserOptions {
  /** Path of Chromium's executable. */
  readonly executablePath: string;
  /**
   * Whether this machine's GPU draws; if false, SwiftShader does, with the same result everywhere.
   */
  readonly usesGpu: boolean;
  /** More arguments for Chromium. */
  readonly args?: readonly string[];
}

/**
 * Chromium features to disable. The list repeats Playwright's relevant ones, because Chromium uses
 * only the last such argument. For each page, Chromium would otherwise load two hidden pages for
 * the address bar and start a spare process: half as much work again as one of our pages.
 */
const DISABLED_FEATURES = [
  'WebUIOmniboxPopup',
  'WebUIOmniboxAimPopup',
  'SpareRendererForSitePerProcess',
  'AimEnabled',
  'AvoidUnnecessaryBeforeUnloadCheckSync',
  'AvoidCorsURLLoaderRestartOnRedirect',
  'DestroyProfileOnBrowserClose',
  'HttpsFirstBalancedModeAutoEnable',
  'HttpsUpgrades',
  'LensOverlay',
  'MediaRouter',
  'NetworkTimeServiceQuerying',
  'OptimizationHints',
  'PaintHolding',
  'PreconnectToSearch',
  'ThirdPartyStoragePartitioning',
];

const COMMON_ARGS = [
  '--headless=new',
  '--no-sandbox',
  '--enable-unsafe-webgpu',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--use-angle=vulkan',
  // Without it, Chromium 156 finds no shared image that both WebGPU and the compositor can use.
  '--enable-features=Vulkan',
  `--disable-features=${DISABLED_FEATURES.join()}`,
];

/** WebGPU and canvases on SwiftShader: both use Vulkan, or `getCurrentTexture` ends WebGPU. */
const SWIFTSHADER_ARGS = [
  '--use-webgpu-adapter=swiftshader',
  '--use-gl=angle',
  '--use-vulkan=swiftshader',
  // Guards of every index take SwiftShader a quarter of its time to compile and to run. Tests in Node
  // have them; without them, an index that is out of bounds ends the GPU process.
  '--enable-dawn-features=disable_robustness',
  // Zeroing 16 KiB of workgroup memory with this extension takes SwiftShader most of a second to
  // compile.
  '--disable-dawn-features=use_vulkan_zero_initialize_workgroup_memory_extension',
  // Compiling shaders for the page around canvases takes SwiftShader a second per browser.
  '--disable-gpu-rasterization',
];

/** Without a display there is no Vulkan surface; the GPU process's sandbox hides driver files. */
const GPU_ARGS = [
  '--use-webgpu-adapter=default',
  '--ignore-gpu-blocklist',
  '--disable-gpu-sandbox',
  '--disable-vulkan-surface',
];

/**
 * ANGLE asks the system's Vulkan loader for a driver, despite --use-vulkan. Without a GPU, the only
 * driver is Chromium's SwiftShader, which the loader finds only through this variable.
 */
function vulkanEnvironment(executablePath: string): Record<string, string> {
  const folders = [dirname(realpathSync(executablePath)), '/usr/lib/chromium'];
  const driver = folders.map((folder) => join(folder, 'vk_swiftshader_icd.json')).find(existsSync);
  return driver ? { VK_ICD_FILENAMES: driver, VK_DRIVER_FILES: driver } : {};
}

/** Starts a headless Chromium in which WebGPU, WebGL and canvases work with and without a GPU. */
export function launchBrowser({ executablePath, usesGpu, args = [] }: BrowserOptions): Promise<Browser> {
  const env = { ...process.env, ...(!usesGpu && vulkanEnvironment(executablePath)) } as Record<
    string,
    string
  >;
  return chromium.launch({
    executablePath,
    args: [...COMMON_ARGS, ...(usesGpu ? GPU_ARGS : SWIFTSHADER_ARGS), ...args],
    // Playwright disables the GPU if there is no display.
    ignoreDefaultArgs: usesGpu ? ['--disable-gpu', '--disable-software-rasterizer'] : [],
    env,
  });
}
