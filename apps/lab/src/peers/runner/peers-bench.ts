import { measurePeers } from './bench.ts';
import type { Bench } from './bench-definition.ts';
import { type BenchOptions, readOptions, USAGE } from './options.ts';
import { choosePeers } from './peer-list.ts';
import { reportText } from './table.ts';

/** Splats loaded as a whole: `npm run bench:peers`. */
export const PEERS_BENCH: Bench<BenchOptions> = {
  script: 'bench:peers',
  packedMain: 'runner/packed-main.ts',
  usage: USAGE,
  readOptions,
  choose: ({ peers, sourcesFolder }, folder) => choosePeers(peers, folder, sourcesFolder),
  async measure(options, peers, setup) {
    const report = await measurePeers(options, peers, setup);
    const hasFailures = report.scenes.some(({ rows }) => rows.some(({ failures }) => failures.length > 0));
    return { report, text: reportText(report), jsonFile: options.jsonFile, hasFailures };
  },
};
