import os from 'node:os';
import corePackage from '../../core/package.json' with { type: 'json' };
import { commitOf } from '../../tools/src/commit.ts';

/** Describes this machine, for measurements. */
export function describeMachine() {
  const cpus = os.cpus();
  return {
    cpu: cpus[0]?.model ?? 'unknown',
    cpuCount: cpus.length,
    memoryGiB: Math.round(os.totalmem() / 2 ** 30),
    system: `${os.type()} ${os.release()} ${os.arch()}`,
    node: process.versions.node,
  };
}

/** Version of the published packages, of which this program is built: its own is not released. */
export const version: string = corePackage.version;

/** Commit of the working copy that this program runs from, as apps that are built name theirs. */
export function currentCommit(): string | null {
  return commitOf(import.meta.dirname);
}
