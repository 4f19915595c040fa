import type { ChosenPeer } from './peer-list.ts';

/** The repository's setup of the peers' packages. */
export interface PeersInstallation {
  /** Whether they are there, in the versions of their lock. */
  readonly isInstalled: () => boolean;
  /** Returns whether it worked. */
  readonly install: () => boolean;
}

/**
 * Installs the missing packages of those `peers` that have some. Clones are left to the caller.
 *
 * @returns the peers that can be measured.
 */
export function withPackages(
  peers: readonly ChosenPeer[],
  { isInstalled, install }: PeersInstallation,
  installs: boolean,
  say: (line: string) => void,
): ChosenPeer[] {
  for (const { name, source } of peers) if (source?.lack) say(`${name} is left out: ${source.lack}`);
  const there = peers.filter(({ source }) => !source?.lack);
  const onDemand = there.filter((peer) => peer.isOnDemand);
  if (onDemand.length === 0 || isInstalled() || (installs && install())) return there;
  const names = onDemand.map(({ name }) => name).join(', ');
  say(`Left out, because their packages are not installed: ${names}.`);
  return there.filter((peer) => !peer.isOnDemand);
}
