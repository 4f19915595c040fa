import type { VulkanRoute } from './vulkan-routes.ts';

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
