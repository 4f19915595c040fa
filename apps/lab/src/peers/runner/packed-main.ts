// `node bench-peers.mjs` in a folder that `--pack` wrote.
import { PEERS_BENCH } from './peers-bench.ts';
import { runPacked } from './run-packed.ts';

process.exitCode = await runPacked(PEERS_BENCH, import.meta.url);
