import { execFile } from 'node:child_process';
import { createRequire } from 'node:module';
import { promisify } from 'node:util';
import { environmentWith } from './vulkan.ts';

/**
 * Path of Deno, whose WebGPU is wgpu, like Firefox's; undefined if npm has not installed it.
 * Depends on the package of one platform: the common package fails to install if a platform's
 * package is missing.
 */
export function findDeno(): string | undefined {
  try {
    return createRequire(import.meta.url).resolve('@deno/linux-x64-glibc/deno');
  } catch {
    // npm has not installed it: its callers skip, and say so.
    return undefined;
  }
}

/**
 * Runs a script in Deno and returns its output.
 *
 * @param driverFile description (ICD) of the Vulkan driver that WebGPU uses.
 * @param args arguments of the script.
 * @throws Error with the end of its stderr if it fails.
 */
export async function runInDeno(
  denoPath: string,
  script: string,
  driverFile: string,
  args: readonly string[] = [],
): Promise<string> {
  const options = { env: environmentWith(driverFile), maxBuffer: 64 * 2 ** 20 };
  const { stdout } = await promisify(execFile)(denoPath, ['run', '--allow-all', script, ...args], options);
  return stdout;
}
