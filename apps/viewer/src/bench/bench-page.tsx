import { InvalidArgumentError, WebGpuUnavailableError } from '@websplatter/core';
import { useCallback, useEffect, useRef, useState } from 'react';
import { reportFailure } from '../messages/failure-report.ts';
import type { FailureReport } from '../state/failure.ts';
import { CopyReports } from '../ui/copy-reports.tsx';
import '../ui/page.css';
import './bench-page.css';
import { viewerAddress } from './bench-address.ts';
import { type BenchReport, benchFileName, benchJson, benchText } from './bench-report.ts';
import { BenchResult } from './bench-result.tsx';
import { CompareSection } from './compare-section.tsx';
import { type BenchProgress, runBench } from './run-bench.ts';

type BenchState =
  | { readonly kind: 'running'; readonly progress: BenchProgress }
  | { readonly kind: 'done'; readonly report: BenchReport }
  | { readonly kind: 'failed'; readonly failure: FailureReport }
  | { readonly kind: 'cancelled' };

const FIRST: BenchState = { kind: 'running', progress: { label: 'Starting', part: undefined } };
/** Drawing the progress takes the GPU's time too: it must not be drawn with every frame. */
const PROGRESS_INTERVAL_MS = 500;

/** The benchmark (`?bench`): runs at once, and shows a report. `data-state` of the document tells how far it is. */
export function BenchPage({ query }: { query: URLSearchParams }) {
  const [state, setState] = useState<BenchState>(FIRST);
  const running = useRef<AbortController | null>(null);
  const run = useCallback(() => {
    running.current?.abort();
    const controller = new AbortController();
    running.current = controller;
    setState(FIRST);
    runBench({ query, signal: controller.signal, onProgress: paced(setState) }).then(
      (report) => setState({ kind: 'done', report }),
      (error) => {
        // Another run may have begun, or the page may have gone.
        if (running.current !== controller) return;
        if (controller.signal.aborted) setState({ kind: 'cancelled' });
        else setState({ kind: 'failed', failure: benchFailure(error) });
      },
    );
  }, [query]);

  useEffect(() => {
    run();
    return () => {
      const controller = running.current;
      running.current = null;
      controller?.abort();
    };
  }, [run]);
  useEffect(() => {
    document.documentElement.dataset.state = state.kind;
  }, [state.kind]);

  return (
    <main className="page" data-testid="bench">
      <header className="page-head">
        <p className="page-trail">
          <a href={viewerAddress(query)}>WebSplatter</a>
        </p>
        <h1>Benchmark</h1>
        <p>
          The same camera path, size and settings on every device, so that reports can be compared. Each frame
          is culled, sorted and drawn anew, and complete before the next begins. The address can ask for
          others: <code>size=1280x720</code>, <code>frames=50</code>, <code>orbit=360</code>,{' '}
          <code>accuracy=fast</code>.
        </p>
      </header>
      {state.kind === 'running' ? (
        <Running progress={state.progress} onCancel={() => running.current?.abort()} />
      ) : (
        <div className="page-actions">
          <button type="button" className="text-button primary" data-testid="bench-again" onClick={run}>
            Run again
          </button>
        </div>
      )}
      <p role="status" className="visually-hidden" data-testid="bench-outcome">
        {OUTCOMES[state.kind]}
      </p>
      {state.kind === 'cancelled' && <p className="page-note">The benchmark was cancelled.</p>}
      {state.kind === 'failed' && <Failed failure={state.failure} />}
      {state.kind === 'done' && <Done report={state.report} />}
    </main>
  );
}

const OUTCOMES: Readonly<Record<BenchState['kind'], string>> = {
  running: 'Measuring',
  done: 'The report is there',
  failed: 'The benchmark has failed',
  cancelled: 'Cancelled',
};

function Running({ progress: { label, part }, onCancel }: { progress: BenchProgress; onCancel: () => void }) {
  return (
    <section className="page-progress" aria-label="Progress">
      <progress aria-label={label} value={part} max={1} />
      <p data-testid="bench-progress">
        {label}
        {part !== undefined && ` · ${Math.round(100 * part)} %`}
      </p>
      <div className="page-actions">
        <button type="button" className="text-button outlined" data-testid="bench-cancel" onClick={onCancel}>
          Cancel
        </button>
      </div>
    </section>
  );
}

function Failed({ failure: { title, message, advice, links = [] } }: { failure: FailureReport }) {
  return (
    <section className="page-failure" role="alert" data-testid="bench-failure">
      <h2>{title}</h2>
      <p>{message}</p>
      {advice && <p>{advice}</p>}
      {links.map(({ label, href }) => (
        <p key={href}>
          <a href={href}>{label}</a>
        </p>
      ))}
    </section>
  );
}

function Done({ report }: { report: BenchReport }) {
  return (
    <>
      <BenchResult report={report} />
      <section aria-labelledby="bench-take">
        <h2 id="bench-take">Report to compare</h2>
        <CopyReports
          testId="bench"
          reports={[
            { format: 'JSON', text: () => benchJson(report), fileName: benchFileName(report) },
            { format: 'text', text: () => benchText(report) },
          ]}
        />
      </section>
      <CompareSection report={report} />
    </>
  );
}

/** Passes progress on when it has another label, or a while after the last. */
function paced(show: (state: BenchState) => void): (progress: BenchProgress) => void {
  let label = '';
  let shownMs = Number.NEGATIVE_INFINITY;
  return (progress) => {
    const nowMs = performance.now();
    if (progress.label === label && nowMs - shownMs < PROGRESS_INTERVAL_MS) return;
    label = progress.label;
    shownMs = nowMs;
    show({ kind: 'running', progress });
  };
}

function benchFailure(error: unknown): FailureReport {
  const failure = reportFailure(error, 'The benchmark');
  if (failure.isFault) console.error(error);
  const isOfBench =
    failure.isFault || error instanceof InvalidArgumentError || error instanceof WebGpuUnavailableError;
  return isOfBench ? { ...failure, title: 'The benchmark cannot run' } : failure;
}
