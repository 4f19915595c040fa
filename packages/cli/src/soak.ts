import { setFlagsFromString } from 'node:v8';
import { runInNewContext } from 'node:vm';
import { soak as runSoak, type SoakReport } from '@websplatter/conformance';
import { WebSplatterError } from '@websplatter/core';
import { createNodeGpu } from '@websplatter/node';
import { type Console, tenthsOf } from './console.ts';
import { UsageError } from './input-error.ts';
import { currentCommit, describeMachine } from './machine.ts';
import { byDefault, flag, parseArguments, SHARED } from './options.ts';

/** `websplatter soak [--frames N] [--seed N] [--json]`. */
export async function soak(args: readonly string[], console: Console): Promise<void> {
  const { values, positionals } = parseArguments(args, {
    frames: byDefault('1000', SHARED.frames),
    seed: byDefault('1', SHARED.seed),
    json: flag,
  });
  if (positionals.length > 0) throw new UsageError('arguments', `soak takes no ${positionals[0]}`);
  const { frames, seed, json } = values;
  const { notice } = await createNodeGpu();
  if (notice !== null) console.err(`note: ${notice}\n`);
  // A fresh adapter per device; createNodeGpu keeps devices from being collected, which kills Dawn.
  const gpu = { requestAdapter: async () => (await createNodeGpu()).adapter };
  const showTenths = tenthsOf(console);
  const onFrame = (frame: number) => showTenths({ done: frame, total: frames, label: `frame ${frame}` });
  const report = await runSoak({ gpu, frames, seed, heapBytes: heapBytesReader(), onFrame });
  console.out(
    json
      ? `${JSON.stringify({ ...report, commit: currentCommit(), machine: describeMachine() }, null, 2)}\n`
      : textOf(report),
  );
  if (report.failures.length > 0) throw new WebSplatterError('soak-failed', report.failures.join(' '));
}

function textOf(report: SoakReport): string {
  const { gpuBytes, heapBytes } = report;
  return [
    `${report.frames} frames with seed ${report.seed} in ${(report.elapsedMs / 1000).toFixed(1)} s on ${report.adapter}`,
    `steps: ${Object.entries(report.steps)
      .toSorted(([, a], [, b]) => b - a)
      .map(([name, count]) => `${name} ${count}`)
      .join(', ')}`,
    `pictures equal to those of fresh engines, bit for bit: ${report.pictures}`,
    `GPU memory: ${mib(gpuBytes.most)} at most, ${mib(gpuBytes.atRest)} without clouds and views, every time`,
    heapBytes && `JavaScript heap: ${mib(heapBytes.early)} after a tenth, ${mib(heapBytes.end)} at the end`,
    '',
  ]
    .filter((line) => line !== null)
    .join('\n');
}

function mib(bytes: number): string {
  return `${(bytes / 2 ** 20).toFixed(2)} MiB`;
}

/** Collects garbage and returns the bytes left. Node has its collector behind a flag. */
function heapBytesReader(): () => number {
  setFlagsFromString('--expose-gc');
  const collect = runInNewContext('gc') as () => void;
  return () => {
    collect();
    return process.memoryUsage().heapUsed;
  };
}
