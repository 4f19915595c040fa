import {
  chooseCases,
  HARD_CASES,
  type HardCase,
  type HardCaseReport,
  type HardCaseResult,
  jsonReport,
  keepRun,
  keptRun,
  keptSentence,
  runHardCases,
  textReport,
  unrunFirst,
} from '@websplatter/conformance';
import { InvalidArgumentError } from '@websplatter/core';
import { type ReactNode, useEffect, useMemo, useRef, useState } from 'react';
import { BUILD } from '../build.ts';
import { CaseVerdict, CellTable, caseAddress, GALLERY, LabPage, Progress, TakeReports } from '../page.tsx';
import { progressText, referenceDecibels, reportByCase } from './run-words.ts';

declare global {
  interface Window {
    /** The newest, for tests and other observers of the page. */
    report?: HardCaseReport;
  }
}

type RunState =
  | { readonly kind: 'idle' | 'running' }
  | { readonly kind: 'done'; readonly report: HardCaseReport }
  | { readonly kind: 'failed'; readonly message: string };

/**
 * Runs the hard cases on this device, all by `?conformance`, some by
 * `?conformance&cases=scale-unit,sort-0-keys`, and reports. `data-state` of the document tells its
 * state.
 */
export default function ConformancePage({ query }: { query: URLSearchParams }) {
  const { cases, problem } = useMemo(() => chosenCases(query.get('cases')), [query]);
  const [state, setState] = useState<RunState>({ kind: 'idle' });
  const [results, setResults] = useState<readonly HardCaseResult[]>([]);
  const [kept, setKept] = useState(() => keptRun());
  const running = useRef<AbortController | null>(null);
  const message = problem ?? (state.kind === 'failed' ? state.message : null);
  const isRunning = state.kind === 'running';
  // Until the run ends, its order stays.
  const ordered = useMemo(() => unrunFirst(cases, kept), [cases, kept]);

  const run = async () => {
    const controller = new AbortController();
    running.current = controller;
    delete window.report;
    setState({ kind: 'running' });
    setResults([]);
    try {
      const report = await runHardCases({
        gpu: navigator.gpu,
        cases: ordered,
        place: { program: navigator.userAgent, ...BUILD },
        onResult: (result) => setResults((before) => [...before, result]),
        signal: controller.signal,
      });
      window.report = report;
      setKept(keepRun(report));
      setState({ kind: 'done', report });
    } catch (error) {
      setState({ kind: 'failed', message: error instanceof Error ? error.message : String(error) });
    }
    running.current = null;
  };

  useEffect(() => {
    document.documentElement.dataset.state = problem ? 'failed' : state.kind;
  }, [problem, state.kind]);
  useEffect(() => () => running.current?.abort(), []);

  return (
    <LabPage
      name="conformance"
      title="Conformance"
      about={
        <>
          Runs {countOf(cases)} on your GPU, in this browser. Every stage of a frame and every image, drawn by
          quads and by tiles, is compared with float64. The run takes a minute or two. Its report contains
          only what this page shows. <a href={GALLERY}>All hard cases</a> shows the scenes.
          {cases.length < HARD_CASES.length && (
            <>
              {' '}
              <a href="?conformance">Choose all {HARD_CASES.length}</a>
            </>
          )}
        </>
      }
    >
      {kept && state.kind === 'idle' && <p data-testid="kept-run">{keptSentence(kept)}</p>}
      {message !== null && (
        <p className="failure" role="alert" data-testid="failure">
          {message}
        </p>
      )}
      {isRunning ? (
        <Progress label={progressText(results, ordered)} done={results.length / cases.length}>
          <StopButton onStop={() => running.current?.abort()} />
        </Progress>
      ) : (
        problem === null && (
          <div className="buttons">
            <button type="button" className="primary" data-testid="run" onClick={() => void run()}>
              {state.kind === 'idle' ? `Run ${countOf(cases)}` : 'Run again'}
            </button>
          </div>
        )
      )}
      {state.kind === 'done' && <Report report={state.report} />}
      {results.length > 0 && <ResultTable results={results} />}
    </LabPage>
  );
}

function countOf(cases: readonly HardCase[]): string {
  if (cases.length === HARD_CASES.length) return `all ${cases.length} hard cases`;
  if (cases.length === 0) return 'hard cases';
  return cases.length === 1 ? 'one hard case' : `${cases.length} hard cases`;
}

/** A case that has begun is finished first, which may take a while. */
function StopButton({ onStop }: { onStop: () => void }) {
  const [isAsked, setAsked] = useState(false);
  return (
    <button
      type="button"
      aria-disabled={isAsked}
      data-testid="stop"
      onClick={() => {
        setAsked(true);
        onStop();
      }}
    >
      {isAsked ? 'Stopping after this case …' : 'Cancel'}
    </button>
  );
}

function Report({ report }: { report: HardCaseReport }) {
  const heading = useRef<HTMLHeadingElement>(null);
  useEffect(() => heading.current?.focus(), []);
  const [headline, ...lines] = textReport(report).replace('WebSplatter: ', '').trimEnd().split('\n');
  const isGood = report.results.every(({ verdict }) => verdict === 'pass');
  return (
    <section aria-labelledby="headline">
      <h2 ref={heading} id="headline" tabIndex={-1} className={isGood ? '' : 'bad'} data-testid="headline">
        {headline}
      </h2>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: keys must reach a box that scrolls. */}
      <pre tabIndex={0} data-testid="report-text">
        {lines.join('\n')}
      </pre>
      <TakeReports
        reports={[
          { format: 'text', text: () => reportByCase(report) },
          {
            format: 'JSON',
            text: () => jsonReport(report),
            fileName: ['websplatter-hard-cases', report.adapter, report.date],
          },
        ]}
      />
    </section>
  );
}

function ResultTable({ results }: { results: readonly HardCaseResult[] }) {
  const [isFailedOnly, setFailedOnly] = useState(false);
  const shown = isFailedOnly ? results.filter(({ verdict }) => verdict === 'fail') : results;
  return (
    <section aria-labelledby="case-by-case">
      <div className="heading">
        <h2 id="case-by-case">Case by case</h2>
        <label>
          <input
            type="checkbox"
            checked={isFailedOnly}
            onChange={(event) => setFailedOnly(event.target.checked)}
          />{' '}
          Only what fails
        </label>
      </div>
      <CellTable
        label="Results"
        testId="results"
        rows={[['Case', 'Group', 'Quads, dB', 'Tiles, dB', 'Time, ms', 'Verdict'], ...shown.map(cellsOf)]}
        wordColumns={2}
      />
      {shown.length === 0 && <p className="note">Nothing has failed.</p>}
    </section>
  );
}

function cellsOf(result: HardCaseResult): ReactNode[] {
  const { name, group, verdict, failures, elapsedMs } = result;
  return [
    <>
      <a href={caseAddress(name)}>{name}</a>
      {failures.map((failure) => (
        <p key={failure} className="bad">
          {failure}
        </p>
      ))}
    </>,
    group,
    ...referenceDecibels(result),
    elapsedMs.toFixed(elapsedMs < 99.95 ? 1 : 0),
    <CaseVerdict key="verdict" verdict={verdict} />,
  ];
}

/** @param names of cases, separated by commas; null for all. */
function chosenCases(names: string | null): {
  readonly cases: readonly HardCase[];
  readonly problem: string | null;
} {
  if (!navigator.gpu) {
    return { cases: HARD_CASES, problem: 'This browser has no WebGPU, or not for this page.' };
  }
  try {
    return { cases: names ? chooseCases(names.split(',')) : HARD_CASES, problem: null };
  } catch (error) {
    if (!(error instanceof InvalidArgumentError)) throw error;
    return { cases: [], problem: error.message };
  }
}
