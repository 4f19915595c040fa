// `node bench-streams.mjs` in a folder that `--pack` wrote.
import { runPacked } from '../runner/run-packed.ts';
import { STREAMS_BENCH } from './streams-bench.ts';

process.exitCode = await runPacked(STREAMS_BENCH, import.meta.url);
