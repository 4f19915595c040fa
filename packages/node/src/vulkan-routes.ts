import { delimiter, dirname, join } from 'node:path';

/** A way to a Vulkan driver: the loader library to load first and the driver description to point it at. */
export interface VulkanRoute {
  /** Names or paths of the Vulkan loader, in the order in which they are tried. */
  readonly loaders: readonly string[];
  /** Driver description (ICD) to use, null to let the loader look in its usual places. */
  readonly driverFile: string | null;
  readonly isSoftware: boolean;
}

/** What choosing looks at, so that a test can pretend. */
export interface VulkanSurroundings {
  readonly env: Readonly<Record<string, string | undefined>>;
  /** Entries of a directory, none where it cannot be read. */
  readonly listDirectory: (path: string) => readonly string[];
  readonly fileExists: (path: string) => boolean;
}

/** Where Chromium's packages put SwiftShader's driver and, beside it, a Vulkan loader. */
const CHROMIUM_DIRECTORIES = ['/usr/lib/chromium', '/usr/lib/chromium-browser', '/opt/google/chrome'];
const SWIFTSHADER_DRIVER = 'vk_swiftshader_icd.json';
/** Mounted into containers by NVIDIA's runtime, outside the places where loaders look. */
const NVIDIA_CONTAINER_DRIVER = '/usr/local/nvidia/share/vulkan/icd.d/nvidia_icd.json';
const LOADER = 'libvulkan.so.1';

/**
 * Ways to a Vulkan driver on Linux, best first: what the system or the user has set up, NVIDIA's container mount,
 * SwiftShader. Only ways whose driver files exist are returned, because Dawn prints a warning for each that fails.
 * `WEBSPLATTER_VK_ICD` names SwiftShader's (or another software) driver file where it is in none of the usual places.
 */
export function vulkanRoutes(surroundings: VulkanSurroundings, forceSoftware = false): VulkanRoute[] {
  const { env, fileExists } = surroundings;
  const softwareDrivers = env.WEBSPLATTER_VK_ICD
    ? [env.WEBSPLATTER_VK_ICD]
    : CHROMIUM_DIRECTORIES.map((directory) => join(directory, SWIFTSHADER_DRIVER));
  const chromiumLoaders = [...softwareDrivers.map(dirname), ...CHROMIUM_DIRECTORIES]
    .map((directory) => join(directory, LOADER))
    .filter((path, index, all) => all.indexOf(path) === index && fileExists(path));
  const loaders = [LOADER, ...chromiumLoaders];

  const routes: VulkanRoute[] = [];
  const isDriverChosen = Boolean(env.VK_DRIVER_FILES || env.VK_ICD_FILENAMES);
  if (!forceSoftware) {
    if (isDriverChosen || hasInstalledDriver(surroundings))
      routes.push({ loaders, driverFile: null, isSoftware: false });
    if (!isDriverChosen && fileExists(NVIDIA_CONTAINER_DRIVER)) {
      routes.push({ loaders, driverFile: NVIDIA_CONTAINER_DRIVER, isSoftware: false });
    }
  }
  const softwareDriver = softwareDrivers.find(fileExists);
  if (softwareDriver) routes.push({ loaders, driverFile: softwareDriver, isSoftware: true });
  return routes;
}

/** Whether any of the directories in which the Vulkan loader looks describes a driver. */
function hasInstalledDriver({ env, listDirectory }: VulkanSurroundings): boolean {
  if (env.VK_ADD_DRIVER_FILES) return true;
  const home = env.HOME ?? '';
  const dataDirectories = [
    '/etc',
    env.XDG_CONFIG_HOME || join(home, '.config'),
    env.XDG_DATA_HOME || join(home, '.local/share'),
    ...(env.XDG_CONFIG_DIRS || '/etc/xdg').split(delimiter),
    ...(env.XDG_DATA_DIRS || '/usr/local/share:/usr/share').split(delimiter),
  ];
  return dataDirectories.some((directory) =>
    listDirectory(join(directory, 'vulkan/icd.d')).some((name) => name.endsWith('.json')),
  );
}
