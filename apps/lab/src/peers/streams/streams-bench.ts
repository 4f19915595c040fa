import type { Bench } from '../runner/bench-definition.ts';
import { measureStreams } from './bench.ts';
import { readStreamsOptions, type StreamsOptions, USAGE } from './options.ts';
import { chooseStreamPeers } from './stream-peers.ts';
import { reportText } from './table.ts';

/** Scenes that stream: `npm run bench:streams`. */
export const STREAMS_BENCH: Bench<StreamsOptions> = {
  script: 'bench:streams',
  packedMain: 'streams/packed-main.ts',
  usage: USAGE,
  readOptions: readStreamsOptions,
  choose: chooseStreamPeers,
  async measure(options, peers, setup) {
    const report = await measureStreams(options, peers, setup);
    const hasFailures = report.rows.some(({ failures }) => failures.length > 0);
    return { report, text: reportText(report), jsonFile: options.jsonFile, hasFailures };
  },
};
