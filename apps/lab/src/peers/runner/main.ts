// `npm run bench:peers`, started by packages/tools/bench-peers.mjs.
import { PEERS_BENCH } from './peers-bench.ts';
import { runBench, type Surroundings } from './run-bench.ts';

export default (args: readonly string[], surroundings: Surroundings): Promise<number> =>
  runBench(PEERS_BENCH, args, surroundings);
