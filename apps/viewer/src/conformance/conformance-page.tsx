import { InvalidArgumentError } from '@websplatter/core';
import {
  chooseCases,
  HARD_CASES,
  type HardCase,
  type HardCaseReport,
  type HardCaseResult,
  jsonReport,
  runHardCases,
  textReport,
} from '@websplatter/hardcases';
import { memo, useEffect, useMemo, useRef, useState } from 'react';
import { caseAddress, GALLERY_ADDRESS } from '../hard-cases/case-addresses.ts';
import { groupTitle } from '../hard-cases/catalogue.ts';
import { CopyReports } from '../ui/copy-reports.tsx';
import '../ui/page.css';
import { BUILD } from '../formatting/build.ts';
import { formatCount, formatMs } from '../formatting/format.ts';
import { progressText, referenceDecibels, reportByCase, reportFileName } from './case-rows.ts';
import './conformance-page.css';

type RunState =
  | { readonly kind: 'idle' | 'running' }
  | { readonly kind: 'done'; readonly report: HardCaseReport }
  | { readonly kind: 'failed'; readonly message: string };

/**
 * Runs the hard cases on this device (`?conformance`, or `?conformance&cases=scale-unit,sort-0-keys` for some), and gives a report.
 * `data-state` of the document tells how far it is.
 */
export function ConformancePage({ query }: { query: URLSearchParams }) {
  const { cases, problem } = useMemo(() => chosenCases(query.get('cases')), [query]);
  const [state, setState] = useState<RunState>({ kind: 'idle' });
  const [results, setResults] = useState<readonly HardCaseResult[]>([]);
  const running = useRef<AbortController | null>(null);
  const message = problem ?? (state.kind === 'failed' ? state.message : null);
  const isRunning = state.kind === 'running';

  const run = async () => {
    const controller = new AbortController();
    running.current = controller;
    setState({ kind: 'running' });
    setResults([]);
    try {
      const report = await runHardCases({
        gpu: navigator.gpu,
        cases,
        place: { program: navigator.userAgent, ...BUILD },
        onResult: (result) => setResults((before) => [...before, result]),
        signal: controller.signal,
      });
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
    <main className="page" data-testid="conformance">
      <header className="page-head">
        <p className="page-trail">
          <a href="?">WebSplatter</a>
          <a href={GALLERY_ADDRESS}>All hard cases</a>
        </p>
        <h1>How this device does</h1>
        <p>
          Runs {countOf(cases)} on your GPU, in this browser: every stage of a frame, for every splat, and
          every image, drawn by quads and by tiles, against float64. It takes a minute or two; the report says
          nothing of you but what is on this page.
          {cases.length < HARD_CASES.length && (
            <>
              {' '}
              <a href="?conformance">Choose all {formatCount(HARD_CASES.length)}</a>
            </>
          )}
        </p>
      </header>
      {message !== null && (
        <p className="page-failure" role="alert" data-testid="conformance-failure">
          {message}
        </p>
      )}
      {isRunning ? (
        <section className="page-progress" aria-label="Progress">
          <progress aria-label="Cases that were run" value={results.length} max={cases.length} />
          <p data-testid="conformance-progress">{progressText(results, cases)}</p>
          <div className="page-actions">
            <StopButton onStop={() => running.current?.abort()} />
          </div>
        </section>
      ) : (
        problem === null && (
          <div className="page-actions">
            <button
              type="button"
              className="text-button primary"
              data-testid="conformance-run"
              onClick={() => void run()}
            >
              {state.kind === 'idle' ? `Run ${countOf(cases)}` : 'Run again'}
            </button>
          </div>
        )
      )}
      {state.kind === 'done' && <Report report={state.report} />}
      {results.length > 0 && <ResultTable results={results} />}
    </main>
  );
}

function countOf(cases: readonly HardCase[]): string {
  if (cases.length === HARD_CASES.length) return `all ${formatCount(cases.length)} hard cases`;
  if (cases.length === 0) return 'hard cases';
  return cases.length === 1 ? 'one hard case' : `${formatCount(cases.length)} hard cases`;
}

/** A case that has begun is finished first, which may take a while. */
function StopButton({ onStop }: { onStop: () => void }) {
  const [isAsked, setAsked] = useState(false);
  return (
    <button
      type="button"
      className="text-button outlined"
      aria-disabled={isAsked}
      data-testid="conformance-stop"
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
    <section aria-labelledby="conformance-headline">
      <h2
        ref={heading}
        id="conformance-headline"
        tabIndex={-1}
        className={isGood ? '' : 'conformance-bad'}
        data-testid="conformance-headline"
      >
        {headline}
      </h2>
      <pre className="conformance-report" data-testid="conformance-report-text">
        {lines.join('\n')}
      </pre>
      <CopyReports
        testId="conformance"
        reports={[
          { format: 'text', text: () => reportByCase(report) },
          { format: 'JSON', text: () => jsonReport(report), fileName: reportFileName(report) },
        ]}
      />
    </section>
  );
}

function ResultTable({ results }: { results: readonly HardCaseResult[] }) {
  const [isFailedOnly, setFailedOnly] = useState(false);
  const shown = isFailedOnly ? results.filter(({ verdict }) => verdict === 'fail') : results;
  return (
    <section aria-labelledby="conformance-cases">
      <div className="conformance-cases">
        <h2 id="conformance-cases">Case by case</h2>
        <label>
          <input
            type="checkbox"
            checked={isFailedOnly}
            onChange={(event) => setFailedOnly(event.target.checked)}
          />{' '}
          Only what fails
        </label>
      </div>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: what scrolls by itself must be reachable by keys. */}
      <section className="page-table" tabIndex={0} aria-label="Results">
        <table data-testid="conformance-results">
          <thead>
            <tr>
              <th scope="col">Case</th>
              <th scope="col">Group</th>
              <th scope="col">Quads, dB</th>
              <th scope="col">Tiles, dB</th>
              <th scope="col">Time, ms</th>
              <th scope="col">Verdict</th>
            </tr>
          </thead>
          <tbody>
            {shown.map((result) => (
              <ResultRow key={result.name} result={result} />
            ))}
          </tbody>
        </table>
      </section>
      {shown.length === 0 && <p className="page-note">Nothing has failed.</p>}
    </section>
  );
}

/** Results do not change once they are there. */
const ResultRow = memo(function ResultRow({ result }: { result: HardCaseResult }) {
  const { name, group, verdict, failures, elapsedMs } = result;
  const [quads, tiles] = referenceDecibels(result);
  const isFailed = verdict === 'fail';
  return (
    <tr className={isFailed ? 'conformance-bad' : ''}>
      <th scope="row">
        <a href={caseAddress(name)}>{name}</a>
        {failures.map((failure) => (
          <p key={failure}>{failure}</p>
        ))}
      </th>
      <td>{groupTitle(group)}</td>
      <td>{quads}</td>
      <td>{tiles}</td>
      <td>{formatMs(elapsedMs)}</td>
      <td className="conformance-verdict">{isFailed ? '✕ fails' : '✓ passes'}</td>
    </tr>
  );
});

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
