// `npm run bench:peers`, started by packages/tools/bench-peers.mjs.
import { join } from 'node:path';
import { commitOf } from '@websplatter/tools/commit';
import { measurePeers } from './bench.ts';
import { buildPages } from './build-pages.ts';
import { type PeersInstallation, withPackages } from './install-peers.ts';
import { readOptions } from './options.ts';
import { writePack } from './pack.ts';
import { choosePeers } from './peer-list.ts';
import { runCommand } from './run-command.ts';

interface Surroundings {
  /** Chromium's program. */
  readonly executablePath: string;
  readonly repositoryRoot: string;
  readonly peersInstallation: PeersInstallation;
  /** From where the command was called. */
  readonly folder: string;
}

/** Runs the bench of this checkout, or packs it; returns the process's exit status. */
export function benchPeers(
  args: readonly string[],
  { executablePath, repositoryRoot, peersInstallation, folder }: Surroundings,
): Promise<number> {
  const commandLine = { name: 'npm run bench:peers --', args };
  return runCommand(commandLine, async ({ workFolder, say }) => {
    const options = readOptions(args, folder);
    const chosen = choosePeers(options.peers, folder, options.sourcesFolder);
    const peers = withPackages(chosen, peersInstallation, options.installs, say);
    const commit = commitOf(repositoryRoot);
    if (options.packFolder) {
      await writePack(peers, options.packFolder, commit, say);
      return null;
    }
    const pagesFolder = join(workFolder, 'pages');
    const pages = await buildPages(peers, pagesFolder, commit, say);
    const setup = { executablePath, commandLine, pages, pagesFolder, workFolder, say };
    return { options, report: await measurePeers(options, pages.peers, setup) };
  });
}
