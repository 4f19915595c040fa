// For Deno: runs every nth hard case, from the given one on, and writes the report. Arguments: first, n.
import process from 'node:process';
import { HARD_CASES, jsonReport, runHardCases } from '@websplatter/conformance';
import { setWorkerUrl } from '@websplatter/core';

setWorkerUrl(new URL('load-worker.js', import.meta.url));
const [first, step] = process.argv.slice(2).map(Number);
const report = await runHardCases({
  gpu: navigator.gpu,
  cases: HARD_CASES.filter((_, i) => i % step === first),
  place: { program: navigator.userAgent, version: 'source', commit: null },
});
process.stdout.write(jsonReport(report));
