import { existsSync, readdirSync } from 'node:fs';
import { basename, delimiter, join } from 'node:path';

/** Driver descriptions (ICDs) that the Vulkan loader finds, sorted by use on this machine. */
export interface InstalledDrivers {
  /** Drivers that may find a GPU here. */
  readonly gpu: readonly string[];
  /** Drivers that render on the CPU. */
  readonly software: readonly string[];
  /** Drivers for GPUs that this machine does not have. */
  readonly idle: readonly string[];
}

const RENDER_NODE = 'renderD';

/**
 * Devices in `/dev` and `/dev/dri`, by the start of their names, without which a driver finds no
 * GPU. Distributions install Mesa's drivers all together, and the loader and Dawn write to stderr
 * for each that finds none. Unlisted drivers, NVIDIA's among them, are always tried.
 */
const NEEDED_DEVICES: Readonly<Record<string, readonly string[]>> = {
  amd: [RENDER_NODE],
  asahi: [RENDER_NODE],
  broadcom: [RENDER_NODE],
  dzn: ['dxg'],
  freedreno: [RENDER_NODE, 'kgsl'],
  intel: [RENDER_NODE],
  intel_hasvk: [RENDER_NODE],
  nouveau: [RENDER_NODE],
  panfrost: [RENDER_NODE],
  powervr_mesa: [RENDER_NODE],
  radeon: [RENDER_NODE],
  virtio: [RENDER_NODE],
};

/** Mesa's lavapipe. */
const SOFTWARE_DRIVER = 'lvp';

/** Drivers in the directories that the Vulkan loader searches; none if the user chose others. */
export function installedDrivers(surroundings: VulkanSurroundings): InstalledDrivers {
  const { env, listDirectory } = surroundings;
  const found: Record<keyof InstalledDrivers, string[]> = { gpu: [], software: [], idle: [] };
  if (isDriverChosen(env)) return found;
  const devices = ['/dev', '/dev/dri'].flatMap(listDirectory);
  const isIdle = (driver: string) =>
    Object.hasOwn(NEEDED_DEVICES, driver) &&
    !NEEDED_DEVICES[driver].some((start) => devices.some((device) => device.startsWith(start)));

  found.gpu.push(...(env.VK_ADD_DRIVER_FILES?.split(delimiter) ?? []));
  for (const directory of driverDirectories(env)) {
    for (const file of listDirectory(directory)) {
      if (!file.endsWith('.json')) continue;
      // radeon_icd.x86_64.json is the driver radeon.
      const [driver] = basename(file, '.json').split('_icd');
      const use = driver === SOFTWARE_DRIVER ? 'software' : isIdle(driver) ? 'idle' : 'gpu';
      found[use].push(join(directory, file));
    }
  }
  return found;
}

/** Whether the user has named the drivers, so that the loader looks for no others. */
export function isDriverChosen(env: VulkanSurroundings['env']): boolean {
  return Boolean(env.VK_DRIVER_FILES || env.VK_ICD_FILENAMES);
}

function driverDirectories(env: VulkanSurroundings['env']): string[] {
  const home = env.HOME ?? '';
  const directories = [
    env.XDG_CONFIG_HOME || join(home, '.config'),
    ...(env.XDG_CONFIG_DIRS || '/etc/xdg').split(delimiter),
    '/etc',
    env.XDG_DATA_HOME || join(home, '.local/share'),
    ...(env.XDG_DATA_DIRS || '/usr/local/share:/usr/share').split(delimiter),
  ];
  return [...new Set(directories)].map((directory) => join(directory, 'vulkan/icd.d'));
}

/** The machine as the search for a driver sees it, so that a test can pretend another one. */
export interface VulkanSurroundings {
  readonly env: Readonly<Record<string, string | undefined>>;
  /** Names in a directory; none if it cannot be read. */
  readonly listDirectory: (path: string) => readonly string[];
  readonly fileExists: (path: string) => boolean;
}

/** This machine. */
export function realSurroundings(): VulkanSurroundings {
  return {
    env: process.env,
    fileExists: existsSync,
    listDirectory(path) {
      try {
        return readdirSync(path);
      } catch {
        // A folder that is missing has no drivers.
        return [];
      }
    },
  };
}
