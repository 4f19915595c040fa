// `npm run bench:peers`: this project beside other renderers, in one browser; see apps/lab.
import { runLabBench } from './lab-bench.mjs';

await runLabBench('runner/main.ts');
