import { spawnSync } from 'node:child_process';
import { existsSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { type ChosenPeer, peersFolder } from './peer-list.ts';

/** Whether the peers' packages are there, in the versions of their lock. */
function isInstalled(): boolean {
  const lock = join(peersFolder, 'package-lock.json');
  const installed = join(peersFolder, 'node_modules/.package-lock.json');
  return existsSync(installed) && statSync(installed).mtimeMs >= statSync(lock).mtimeMs;
}

/**
 * Installs the packages of those `peers` that have some, unless they are there.
 *
 * @returns the peers that can be measured.
 */
export function withPackages(
  peers: readonly ChosenPeer[],
  installs: boolean,
  say: (line: string) => void,
): ChosenPeer[] {
  const onDemand = peers.filter((peer) => peer.isOnDemand);
  if (onDemand.length === 0 || isInstalled()) return [...peers];
  if (installs) {
    say('Installing the peers’ packages in apps/bench/peers (npm ci --ignore-scripts) …');
    const { status } = spawnSync('npm', ['ci', '--ignore-scripts'], {
      cwd: peersFolder,
      stdio: ['ignore', 'ignore', 'inherit'],
      shell: process.platform === 'win32',
    });
    if (status === 0) return [...peers];
  }
  const names = onDemand.map(({ name }) => name).join(', ');
  say(`Left out, because their packages are not installed: ${names}.`);
  return peers.filter((peer) => !peer.isOnDemand);
}
