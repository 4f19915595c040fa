import { join } from 'node:path';
import { commitOf } from '@websplatter/tools/commit';
import type { Bench, CommonOptions } from './bench-definition.ts';
import { buildPages } from './build-pages.ts';
import { type PeersInstallation, withPackages } from './install-peers.ts';
import { writePack } from './pack.ts';
import { runCommand } from './run-command.ts';

export interface Surroundings {
  /** Chromium's program. */
  readonly executablePath: string;
  readonly repositoryRoot: string;
  readonly peersInstallation: PeersInstallation;
  /** From where the command was called. */
  readonly folder: string;
}

/** Runs a bench of this checkout, or packs it; returns the process's exit status. */
export function runBench<Options extends CommonOptions>(
  bench: Bench<Options>,
  args: readonly string[],
  { executablePath, repositoryRoot, peersInstallation, folder }: Surroundings,
): Promise<number> {
  const commandLine = { name: `npm run ${bench.script} --`, args, usage: bench.usage };
  return runCommand(commandLine, async ({ workFolder, say }) => {
    const options = bench.readOptions(args, folder);
    const peers = withPackages(bench.choose(options, folder), peersInstallation, options.installs, say);
    const commit = commitOf(repositoryRoot);
    if (options.packFolder) {
      await writePack(bench, peers, options.packFolder, commit, say);
      return null;
    }
    const pagesFolder = join(workFolder, 'pages');
    const pages = await buildPages(peers, pagesFolder, commit, say);
    const setup = { executablePath, commandLine, pages, pagesFolder, workFolder, say };
    return bench.measure(options, pages.peers, setup);
  });
}
