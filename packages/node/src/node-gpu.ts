import { execFile } from 'node:child_process';
import { createRequire } from 'node:module';
import os from 'node:os';
import { basename, delimiter, dirname, isAbsolute } from 'node:path';
import { pathToFileURL } from 'node:url';
import { adapterLabel, isSoftwareAdapter, WebGpuUnavailableError } from '@websplatter/core';
import { installedDrivers, realSurroundings } from './installed-drivers.ts';
import { type VulkanRoute, vulkanRoutes } from './vulkan-routes.ts';

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

/** An absolute path, as libwayland demands, where no compositor's socket can lie. */
const NO_RUNTIME_DIRECTORY = '/dev/null';

/** Environment variables to set while Dawn opens the drivers of `route`, on top of `env`. */
export function routeEnvironment(
  { driverFiles }: VulkanRoute,
  env: Readonly<Record<string, string | undefined>>,
): Record<string, string> {
  const variables: Record<string, string> = {};
  if (driverFiles !== null) {
    variables.VK_DRIVER_FILES = driverFiles.join(':');
    // For loaders older than 1.3.207.
    variables.VK_ICD_FILENAMES = variables.VK_DRIVER_FILES;
  }
  // Mesa's device-select layer, which the loader adds to every driver, asks the Wayland compositor
  // for its GPU. Without this variable libwayland writes "error: XDG_RUNTIME_DIR is invalid or not
  // set", twice per adapter search. The layer itself stays: users choose GPUs through it
  // (MESA_VK_DEVICE_SELECT, DRI_PRIME).
  if (!env.XDG_RUNTIME_DIR?.startsWith('/')) variables.XDG_RUNTIME_DIR = NO_RUNTIME_DIRECTORY;
  return variables;
}

/** A driver that has not opened by then never will. */
const PROBE_TIMEOUT_MS = 30_000;

/** Arguments: the address of the package webgpu, and the options of `requestAdapter`. */
const PROBE = `
const [webgpu, options] = process.argv.slice(1);
const { create } = await import(webgpu);
process.exit((await create([]).requestAdapter(JSON.parse(options))) ? 0 : 1);
`;

/**
 * Finds out in a process of its own whether Dawn gets an adapter. Failing drivers make the loader
 * and Dawn write to stderr, which cannot be turned off, and have ended the process: neither reaches
 * this one.
 *
 * @param loader name or path of the Vulkan loader.
 * @param env environment variables that choose the drivers, besides this process's own.
 */
export function opensAdapter(
  loader: string,
  env: Readonly<Record<string, string>>,
  adapterOptions: GPURequestAdapterOptions,
): Promise<boolean> {
  const webgpu = pathToFileURL(createRequire(import.meta.url).resolve('webgpu')).href;
  const args = ['--input-type=module', '--eval', PROBE, webgpu, JSON.stringify(adapterOptions)];
  const surroundings: NodeJS.ProcessEnv = { ...process.env, ...env };
  // Preloads and watch mode of this process are not for the child.
  delete surroundings.NODE_OPTIONS;
  // Dawn asks for the loader by name.
  if (isAbsolute(loader)) {
    const others = surroundings.LD_LIBRARY_PATH;
    surroundings.LD_LIBRARY_PATH = others ? `${dirname(loader)}${delimiter}${others}` : dirname(loader);
  }
  return new Promise((resolve) => {
    const options = { env: surroundings, timeout: PROBE_TIMEOUT_MS };
    execFile(process.execPath, args, options, (error) => resolve(error === null));
  });
}
