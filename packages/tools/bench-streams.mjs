// `npm run bench:streams`: scenes that stream beside those of other renderers; see apps/lab.
import { runLabBench } from './lab-bench.mjs';

await runLabBench('streams/main.ts');
