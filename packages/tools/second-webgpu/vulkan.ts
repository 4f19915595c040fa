import { readdirSync } from 'node:fs';
import { join } from 'node:path';

/** Where distributions install the descriptions (ICDs) of Vulkan drivers. */
const DRIVER_FOLDER = '/usr/share/vulkan/icd.d';

/** Path of the description (ICD) of lavapipe, Mesa's CPU driver; undefined if not installed. */
export function findLavapipe(): string | undefined {
  try {
    const name = readdirSync(DRIVER_FOLDER).find((each) => each.startsWith('lvp_icd'));
    return name && join(DRIVER_FOLDER, name);
  } catch {
    // There is no folder of drivers: callers skip, and say so.
    return undefined;
  }
}

/** This process's environment, limited to the Vulkan driver of `driverFile`. */
export function environmentWith(driverFile: string): NodeJS.ProcessEnv {
  return {
    ...process.env,
    VK_DRIVER_FILES: driverFile,
    // For loaders older than 1.3.207.
    VK_ICD_FILENAMES: driverFile,
    // Mesa looks for a compositor's socket there, and warns if the variable is missing.
    XDG_RUNTIME_DIR: process.env.XDG_RUNTIME_DIR ?? '/dev/null',
  };
}
