import { basename, dirname, join } from 'node:path';
import { installedDrivers, isDriverChosen, type VulkanSurroundings } from './installed-drivers.ts';

/** A way to a Vulkan driver: a loader library, and the driver descriptions to point it at. */
export interface VulkanRoute {
  /** Names or paths of the Vulkan loader, in the order in which to try them. */
  readonly loaders: readonly string[];
  /** Driver descriptions (ICDs) to use, null to let the loader look in its usual places. */
  readonly driverFiles: readonly string[] | null;
  readonly isSoftware: boolean;
  /** Whether the driver may find no GPU here, and write so to stderr: probe it in a child process. */
  readonly mayFail: boolean;
}

/** Directories in which Chromium's packages install SwiftShader's driver and a Vulkan loader. */
const CHROMIUM_DIRECTORIES = ['/usr/lib/chromium', '/usr/lib/chromium-browser', '/opt/google/chrome'];
const SWIFTSHADER_DRIVER = 'vk_swiftshader_icd.json';
/** A device in `/dev` that NVIDIA's kernel module makes where it has a GPU. */
const NVIDIA_DEVICE = 'nvidiactl';
/** NVIDIA's container runtime mounts this file, outside the directories in which loaders look. */
const NVIDIA_CONTAINER_DRIVER = '/usr/local/nvidia/share/vulkan/icd.d/nvidia_icd.json';
const LOADER = 'libvulkan.so.1';

/**
 * Lists the ways to a Vulkan driver on Linux, best first: the GPU drivers that the system or the
 * user has set up, NVIDIA's container mount, then software (SwiftShader, or else Mesa's lavapipe).
 * Leaves out missing driver files and installed drivers that have no GPU here, because the loader
 * and Dawn write to stderr about every driver that fails, and says which others may fail.
 *
 * `WEBSPLATTER_VK_ICD` names the file of a software driver to use instead of these two.
 */
export function vulkanRoutes(surroundings: VulkanSurroundings, forceSoftware = false): VulkanRoute[] {
  const { env, fileExists } = surroundings;
  const installed = installedDrivers(surroundings);
  const softwareDrivers = env.WEBSPLATTER_VK_ICD
    ? [env.WEBSPLATTER_VK_ICD]
    : CHROMIUM_DIRECTORIES.map((directory) => join(directory, SWIFTSHADER_DRIVER));
  const chromiumLoaders = [...softwareDrivers.map(dirname), ...CHROMIUM_DIRECTORIES]
    .map((directory) => join(directory, LOADER))
    .filter((path, index, all) => all.indexOf(path) === index && fileExists(path));
  const loaders = [LOADER, ...chromiumLoaders];
  if (!env.WEBSPLATTER_VK_ICD) softwareDrivers.push(...installed.software);

  const hasNvidia = surroundings.listDirectory('/dev').includes(NVIDIA_DEVICE);
  const mayFail = (file: string) => !(hasNvidia && basename(file).startsWith('nvidia'));
  const routes: VulkanRoute[] = [];
  if (!forceSoftware) {
    const isChosen = isDriverChosen(env);
    if (isChosen || installed.gpu.length > 0) {
      const areAllWanted = isChosen || installed.software.length + installed.idle.length === 0;
      routes.push({
        loaders,
        driverFiles: areAllWanted ? null : installed.gpu,
        isSoftware: false,
        mayFail: isChosen || installed.gpu.some(mayFail),
      });
    }
    if (!isChosen && fileExists(NVIDIA_CONTAINER_DRIVER)) {
      routes.push({
        loaders,
        driverFiles: [NVIDIA_CONTAINER_DRIVER],
        isSoftware: false,
        mayFail: mayFail(NVIDIA_CONTAINER_DRIVER),
      });
    }
  }
  const softwareDriver = softwareDrivers.find(fileExists);
  if (softwareDriver) {
    routes.push({
      loaders,
      driverFiles: [softwareDriver],
      isSoftware: true,
      // Lavapipe may lack features that Dawn needs.
      mayFail: basename(softwareDriver) !== SWIFTSHADER_DRIVER,
    });
  }
  return routes;
}
