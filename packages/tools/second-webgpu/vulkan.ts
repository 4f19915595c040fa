import { readdirSync } from 'node:fs';
import { join } from 'node:path';

/** Where distributions install the descriptions (ICDs) of Vulkan drivers. */
const DRIVER_FOLDER = '/usr/share/vulkan/icd.d';

/** Path of the description of lavapipe, Mesa's driver for the CPU; undefined if not installed. */
export function findLavapipe(): string | undefined {
  try {
    const name = readdirSync(DRIVER_FOLDER).find((each) => each.startsWith('lvp_icd'));
    return name && join(DRIVER_FOLDER, name);
  } catch {
    return undefined;
  }
}

/** This process's environment, in which Vulkan finds no driver but that of `driverFile`. */
export function environmentWith(driverFile: string): NodeJS.ProcessEnv {
  return {
    ...process.env,
    VK_DRIVER_FILES: driverFile,
    // For loaders older than 1.3.207.
    VK_ICD_FILENAMES: driverFile,
    // Mesa asks for a compositor's socket there, and complains where the variable is missing.
    XDG_RUNTIME_DIR: process.env.XDG_RUNTIME_DIR ?? '/dev/null',
  };
}
