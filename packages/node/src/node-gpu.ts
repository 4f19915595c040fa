import os from 'node:os';
import { basename } from 'node:path';
import { adapterLabel, isSoftwareAdapter, WebGpuUnavailableError } from '@websplatter/core';
import { opensAdapter } from './driver-probe.ts';
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
  /** Unused: an adapter gives one device only. */
  readonly adapter: GPUAdapter;
  /** Human-readable name of the adapter, e.g. `google swiftshader`. */
  readonly label: string;
  readonly isSoftware: boolean;
  /** Message for the user when no GPU was found, otherwise null. */
  readonly notice: string | null;
}

/**
 * Finds a WebGPU adapter through Dawn: a GPU, or else a software driver. Defines missing WebGPU
 * constants and classes (`GPUBufferUsage`, …) as globals. Every call returns a fresh adapter of the
 * same GPU.
 *
 * @throws WebGpuUnavailableError if no adapter is found; its message lists the attempts and the
 *   packages to install.
 */
export async function createNodeGpu(options: NodeGpuOptions = {}): Promise<NodeGpu> {
  const forceSoftware = options.forceSoftware ?? false;
  let choosing = chosen.get(forceSoftware);
  if (!choosing) {
    choosing = choose(forceSoftware);
    chosen.set(forceSoftware, choosing);
    // Try again on the next call: the user may have installed a driver by then.
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
 * Instances, adapters and devices, referenced as long as the process lives: Dawn aborts the process
 * (`std::system_error: Invalid argument`) once one of them has been garbage-collected.
 */
const keptForever = new Set<unknown>();

/** Rounding of timestamps protects web pages from one another; this process has no other pages. */
const UNWANTED_FEATURES = ['timestamp_quantization'];
/**
 * With this Vulkan extension SwiftShader compiles one store per word of workgroup memory, which
 * takes most of a second for 16 KiB. Without it Dawn writes an equivalent loop that compiles in 20
 * ms.
 */
const UNWANTED_IN_SOFTWARE = ['use_vulkan_zero_initialize_workgroup_memory_extension'];

async function choose(forceSoftware: boolean): Promise<Choice> {
  const tried: string[] = [];
  // Metal and Direct3D are always there; on Linux a Vulkan loader and a driver have to be found.
  const surroundings = process.platform === 'linux' ? realSurroundings() : null;
  const routes = surroundings ? vulkanRoutes(surroundings, forceSoftware) : [null];
  for (const route of routes) {
    const loader = route?.loaders.find(loadVulkan);
    if (route && !loader) {
      tried.push(`no Vulkan loader (${route.loaders.join(', ')}) can be loaded`);
      continue;
    }
    const dawn = await loadDawn();
    const isOpenable =
      !route?.mayFail ||
      !loader ||
      (await opensAdapter(loader, routeEnvironment(route, process.env), adapterOptions(forceSoftware)));
    const choice =
      isOpenable && (await onRoute(route, () => openGpu(dawn, forceSoftware, route?.isSoftware ?? false)));
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
 * Loads a Vulkan loader, if possible. Dawn opens `libvulkan.so.1` by name and gets a library of that
 * name that is already in the process: so Chromium's copy works, which is not on the library path.
 */
function loadVulkan(loader: string): boolean {
  const { RTLD_NOW, RTLD_GLOBAL } = os.constants.dlopen;
  const RTLD_NODELETE = 0x1000;
  try {
    process.dlopen({ exports: {} }, loader, RTLD_NOW | RTLD_GLOBAL | RTLD_NODELETE);
    return true;
  } catch (error) {
    // Node complains that the library is no addon, but RTLD_NODELETE keeps it loaded.
    return error instanceof Error && error.message.includes('did not self-register');
  }
}

/** Runs `open` in the environment that `route` needs; later child processes do not inherit it. */
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
