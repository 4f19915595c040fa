import os from 'node:os';
import { basename } from 'node:path';
import { adapterLabel, isSoftwareAdapter, WebGpuUnavailableError } from '@websplatter/core';
import { installedDrivers } from './installed-drivers.ts';
import { routeEnvironment } from './route-environment.ts';
import { type VulkanRoute, vulkanRoutes } from './vulkan-routes.ts';
import { realSurroundings } from './vulkan-surroundings.ts';

export interface NodeGpuOptions {
  /** Use the software adapter even where there is a GPU. Default false. */
  readonly forceSoftware?: boolean;
}

/** WebGPU in this process. */
export interface NodeGpu {
  readonly gpu: GPU;
  /** Not yet used: a device can be made from it once. */
  readonly adapter: GPUAdapter;
  /** What a person would call the adapter, e.g. `google swiftshader`. */
  readonly label: string;
  readonly isSoftware: boolean;
  /** What the user should know about the choice, null where a GPU was found. */
  readonly notice: string | null;
}

/**
 * Finds a WebGPU adapter through Dawn: a GPU, or else a software driver. Makes the constants and classes of WebGPU
 * (`GPUBufferUsage`, …) global where they are missing. Every call returns a fresh adapter of the same GPU.
 *
 * @throws WebGpuUnavailableError where nothing works, saying what to install.
 */
export async function createNodeGpu(options: NodeGpuOptions = {}): Promise<NodeGpu> {
  const forceSoftware = options.forceSoftware ?? false;
  let choosing = chosen.get(forceSoftware);
  if (!choosing) {
    choosing = choose(forceSoftware);
    chosen.set(forceSoftware, choosing);
    // What is missing may be installed before the next call.
    choosing.catch(() => chosen.delete(forceSoftware));
  }
  const { gpu, firstAdapter } = await choosing;
  const adapter = unusedFirstAdapters.delete(firstAdapter)
    ? firstAdapter
    : await gpu.requestAdapter(adapterOptions(forceSoftware));
  if (!adapter) throw new WebGpuUnavailableError('The GPU that was here before can no longer be found.');
  keepDevices(adapter);
  const label = adapterLabel(adapter.info);
  const isSoftware = isSoftwareAdapter(adapter.info);
  const notice = isSoftware ? `no GPU is used: rendering in software on ${label}, which is slow` : null;
  return { gpu, adapter, label, isSoftware, notice };
}

interface Choice {
  readonly gpu: GPU;
  readonly firstAdapter: GPUAdapter;
}

type Dawn = typeof import('webgpu');

const chosen = new Map<boolean, Promise<Choice>>();
const unusedFirstAdapters = new Set<GPUAdapter>();

/**
 * Dawn aborts the process (`std::system_error: Invalid argument`) once an instance, adapter or device has been
 * garbage-collected: these stay referenced as long as the process lives.
 */
const keptForever = new Set<unknown>();

/** Timestamps are not rounded: this process measures itself, no page spies on another. */
const UNWANTED_FEATURES = ['timestamp_quantization'];
/**
 * SwiftShader takes most of a second to compile what this Vulkan extension asks for, a store for each word of workgroup
 * memory; without it Dawn writes a loop that does the same, and 16 KiB compile in 20 ms.
 */
const UNWANTED_IN_SOFTWARE = ['use_vulkan_zero_initialize_workgroup_memory_extension'];

async function choose(forceSoftware: boolean): Promise<Choice> {
  const tried: string[] = [];
  // Metal and Direct3D need no looking for; on Linux a Vulkan loader and a driver do.
  const surroundings = process.platform === 'linux' ? realSurroundings() : null;
  const routes = surroundings ? vulkanRoutes(surroundings, forceSoftware) : [null];
  for (const route of routes) {
    if (route && !loadVulkan(route.loaders)) {
      tried.push(`no Vulkan loader (${route.loaders.join(', ')}) can be loaded`);
      continue;
    }
    const dawn = await loadDawn();
    const choice = await onRoute(route, () => openGpu(dawn, forceSoftware, route?.isSoftware ?? false));
    if (choice) return choice;
    const drivers = route?.driverFiles?.join(', ') ?? 'the system’s graphics driver';
    tried.push(`${drivers} offers no WebGPU adapter`);
  }
  const idle = surroundings && !forceSoftware ? installedDrivers(surroundings).idle : [];
  if (idle.length > 0) {
    tried.push(
      `/dev shows no GPU for ${idle.map((file) => basename(file)).join(', ')} (a container must be given it: \`docker run --device /dev/dri\`)`,
    );
  }
  if (tried.length === 0) tried.push('no Vulkan driver is installed');
  const remedy = surroundings
    ? 'Install a Vulkan driver for the GPU (`apt-get install libvulkan1 mesa-vulkan-drivers`, or NVIDIA’s), or a software one: `apt-get install chromium`.'
    : 'Update the graphics driver.';
  throw new WebGpuUnavailableError(`No WebGPU adapter: ${tried.join('; ')}. ${remedy}`);
}

async function openGpu(dawn: Dawn, forceSoftware: boolean, isSoftware: boolean): Promise<Choice | null> {
  const unwanted = [...UNWANTED_FEATURES, ...(isSoftware ? UNWANTED_IN_SOFTWARE : [])];
  const gpu = dawn.create([`disable-dawn-features=${unwanted.join(',')}`]);
  keptForever.add(gpu);
  const firstAdapter = await gpu.requestAdapter(adapterOptions(forceSoftware));
  if (!firstAdapter) return null;
  unusedFirstAdapters.add(firstAdapter);
  return { gpu, firstAdapter };
}

function adapterOptions(forceSoftware: boolean): GPURequestAdapterOptions {
  return forceSoftware ? { forceFallbackAdapter: true } : { powerPreference: 'high-performance' };
}

async function loadDawn(): Promise<Dawn> {
  let dawn: Dawn;
  try {
    dawn = await import('webgpu');
  } catch (cause) {
    const reason = cause instanceof Error ? cause.message.split('\n')[0] : String(cause);
    throw new WebGpuUnavailableError(
      `Dawn (npm package webgpu) does not load on ${process.platform} ${process.arch}: ${reason}`,
      { cause },
    );
  }
  for (const [name, value] of Object.entries(dawn.globals)) {
    if (!(name in globalThis))
      Object.defineProperty(globalThis, name, { value, configurable: true, writable: true });
  }
  return dawn;
}

/**
 * Loads the first Vulkan loader that can be. Dawn asks for `libvulkan.so.1` by name and gets the one that is already
 * in the process, which is how Chromium's copy, outside the library path, serves.
 */
function loadVulkan(loaders: readonly string[]): boolean {
  const { RTLD_NOW, RTLD_GLOBAL } = os.constants.dlopen;
  const RTLD_NODELETE = 0x1000;
  return loaders.some((loader) => {
    try {
      process.dlopen({ exports: {} }, loader, RTLD_NOW | RTLD_GLOBAL | RTLD_NODELETE);
      return true;
    } catch (error) {
      // It is a library, not an addon: node complains, but with NODELETE the library stays loaded.
      return error instanceof Error && error.message.includes('did not self-register');
    }
  });
}

/** Runs `open` in the environment that `route` needs; child processes that are started later do not inherit it. */
async function onRoute<T>(route: VulkanRoute | null, open: () => Promise<T>): Promise<T> {
  const variables = route ? Object.entries(routeEnvironment(route, process.env)) : [];
  const before = variables.map(([name]) => process.env[name]);
  for (const [name, value] of variables) process.env[name] = value;
  try {
    return await open();
  } finally {
    variables.forEach(([name], i) => {
      if (before[i] === undefined) delete process.env[name];
      else process.env[name] = before[i];
    });
  }
}

function keepDevices(adapter: GPUAdapter): void {
  if (keptForever.has(adapter)) return;
  keptForever.add(adapter);
  const requestDevice = adapter.requestDevice.bind(adapter);
  adapter.requestDevice = async (descriptor) => {
    const device = await requestDevice(descriptor);
    keptForever.add(device);
    return device;
  };
}
