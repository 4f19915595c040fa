import { execFile } from 'node:child_process';
import { createRequire } from 'node:module';
import { delimiter, dirname, isAbsolute } from 'node:path';
import { pathToFileURL } from 'node:url';

/** Longest time for a driver to open: slower ones are taken for hanging, ms. */
const PROBE_TIMEOUT_MS = 30_000;

/** Script with two arguments: the URL of the package webgpu, and options of `requestAdapter`. */
const PROBE = `
const [webgpu, options] = process.argv.slice(1);
const { create } = await import(webgpu);
process.exit((await create([]).requestAdapter(JSON.parse(options))) ? 0 : 1);
`;

/**
 * Tests in a child process whether Dawn gets an adapter. Failing drivers make the loader and Dawn
 * write to stderr, which cannot be turned off, or crash: neither affects this process.
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
  // The child must not inherit preloads and watch mode of this process.
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
