import { execFileSync } from 'node:child_process';
import os from 'node:os';

/** A page that is isolated from other origins may share memory with its workers. */
export const PAGE_HEADERS = {
  'cross-origin-opener-policy': 'same-origin',
  'cross-origin-embedder-policy': 'require-corp',
  'cross-origin-resource-policy': 'same-origin',
  'cache-control': 'no-store',
};

/** This machine and the browser at a path, in words. */
export function machineOf(executablePath: string): { readonly machine: string; readonly browser: string } {
  const cpus = os.cpus();
  const memoryGiB = Math.round(os.totalmem() / 2 ** 30);
  return {
    machine: `${cpus.length} × ${cpus[0]?.model ?? 'unknown'}, ${memoryGiB} GiB; ${os.type()} ${os.release()}; Node ${process.versions.node}`,
    browser: execFileSync(executablePath, ['--version'], { encoding: 'utf8' }).trim(),
  };
}
