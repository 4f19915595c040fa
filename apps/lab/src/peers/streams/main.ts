// `npm run bench:streams`, started by packages/tools/bench-streams.mjs.
import { runBench, type Surroundings } from '../runner/run-bench.ts';
import { STREAMS_BENCH } from './streams-bench.ts';

export default (args: readonly string[], surroundings: Surroundings): Promise<number> =>
  runBench(STREAMS_BENCH, args, surroundings);
