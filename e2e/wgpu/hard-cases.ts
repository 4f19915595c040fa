// For Deno: runs the hard cases that the arguments name, or all of them, and writes the report.
import process from 'node:process';
import { chooseCases, HARD_CASES, jsonReport, runHardCases } from '@websplatter/hardcases';

const names = process.argv.slice(2);
const report = await runHardCases({
  gpu: navigator.gpu,
  cases: names.length === 0 ? HARD_CASES : chooseCases(names),
  place: { program: navigator.userAgent, version: 'source', commit: null },
});
process.stdout.write(jsonReport(report));
