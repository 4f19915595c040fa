// For Deno: runs the hard cases, and writes the report.
import process from 'node:process';
import { HARD_CASES, jsonReport, runHardCases } from '@websplatter/conformance';
import { setWorkerUrl } from '@websplatter/core';

setWorkerUrl(new URL('load-worker.js', import.meta.url));
const report = await runHardCases({
  gpu: navigator.gpu,
  cases: HARD_CASES,
  place: { program: navigator.userAgent, version: 'source', commit: null },
});
process.stdout.write(jsonReport(report));
