import {
  failureLines,
  HARD_CASES,
  type HardCase,
  type HardCaseReport,
  jsonReport,
  markdownReport,
  resultHeading,
  resultLine,
  runHardCases,
  summaryLine,
} from '@websplatter/conformance';
import { WebSplatterError } from '@websplatter/core';
import { createNodeGpu } from '@websplatter/node';
import type { Console } from './console.ts';
import { UsageError } from './input-error.ts';
import { currentCommit, version } from './machine.ts';
import { byDefault, flag, parseArguments, parsed, text } from './options.ts';

interface HardCaseOptions {
  readonly format: 'table' | 'json' | 'markdown';
  /** The chosen cases, at least one. */
  readonly cases: readonly HardCase[];
  readonly sizePx: number;
}

/** `websplatter hardcases [--json | --markdown] [--filter text] [--size 64x64]`. */
export async function hardcases(args: readonly string[], console: Console): Promise<void> {
  const { format, cases, sizePx } = parseHardCaseArguments(args);
  const { notice } = await createNodeGpu();
  if (notice !== null) console.err(`note: ${notice}\n`);
  // A fresh adapter per device; createNodeGpu keeps devices from being collected, which kills Dawn.
  const gpu = { requestAdapter: async () => (await createNodeGpu()).adapter };
  const nameWidth = Math.max(...cases.map(({ name }) => name.length));
  if (format === 'table') console.out(`${resultHeading(nameWidth)}\n`);
  const report = await runHardCases({
    gpu,
    cases,
    sizePx,
    place: {
      program: `Node ${process.versions.node}`,
      version,
      commit: currentCommit(),
    },
    onResult: (result) => {
      if (format === 'table') console.out(`${resultLine(result, nameWidth)}\n`);
    },
  });
  console.out(textOf(report, format));
  const { results } = report;
  const failed = results.filter(({ verdict }) => verdict === 'fail').length;
  if (failed > 0)
    throw new WebSplatterError('hard-cases-failed', `${failed} of ${results.length} hard cases fail`);
}

function textOf(report: HardCaseReport, format: HardCaseOptions['format']): string {
  if (format === 'json') return jsonReport(report);
  if (format === 'markdown') return markdownReport(report);
  return `${['', ...failureLines(report.results), summaryLine(report)].join('\n')}\n`;
}

/** @throws UsageError that names the argument. */
function parseHardCaseArguments(args: readonly string[]): HardCaseOptions {
  const { values } = parseArguments(
    args,
    {
      json: flag,
      markdown: flag,
      filter: byDefault('', text),
      size: byDefault('64x64', parsed(parseSquare)),
    },
    ([first]) => {
      if (first !== undefined)
        throw new UsageError('arguments', `hardcases takes no ${first}; --filter chooses cases by name`);
    },
  );
  if (values.json && values.markdown)
    throw new UsageError('--markdown', '--json and --markdown are two formats; give one');
  const cases = HARD_CASES.filter(({ name }) => name.includes(values.filter));
  if (cases.length === 0)
    throw new UsageError('--filter', `--filter is ${values.filter}; no case has that in its name`);
  const format = values.json ? 'json' : values.markdown ? 'markdown' : 'table';
  return { format, cases, sizePx: values.size };
}

function parseSquare(text: string): number {
  const [, width, height] = /^(\d+)[x×](\d+)$/i.exec(text) ?? [];
  const sizePx = Number(width);
  if (width === undefined || width !== height || sizePx < 1 || sizePx > 1024) {
    throw new UsageError(
      '--size',
      `--size is ${text}; the cases are made for squares, such as 64x64, of 1 to 1024 pixels`,
    );
  }
  return sizePx;
}
