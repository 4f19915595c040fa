import { passTable, timeNotes, timeRows, timeTable } from '@websplatter/charts';
import { WebSplatterError } from '@websplatter/core';
import { useCallback, useEffect, useRef, useState } from 'react';
import { CellTable, LabPage, Progress, TakeReports } from '../page.tsx';
import {
  type BenchmarkReport,
  comparedRows,
  differencesOf,
  type FrameReport,
  readReport,
  reportFacts,
  reportText,
} from './report.ts';
import { type BenchmarkProgress, runBenchmark } from './run.ts';

type BenchmarkState =
  | { readonly kind: 'running'; readonly progress: BenchmarkProgress }
  | { readonly kind: 'done'; readonly report: BenchmarkReport }
  | { readonly kind: 'failed'; readonly message: string }
  | { readonly kind: 'cancelled' };

const FIRST: BenchmarkState = { kind: 'running', progress: { label: 'Starting', part: undefined } };
/** Drawing the progress takes the GPU's time too: it must not be drawn with every frame. */
const PROGRESS_INTERVAL_MS = 500;

/** The benchmark (`?bench`): runs at once and reports. The document's `data-state` is its state. */
export default function BenchmarkPage({ query }: { query: URLSearchParams }) {
  const [state, setState] = useState<BenchmarkState>(FIRST);
  const running = useRef<AbortController | null>(null);
  const run = useCallback(() => {
    running.current?.abort();
    const controller = new AbortController();
    running.current = controller;
    setState(FIRST);
    runBenchmark(query, controller.signal, paced(setState)).then(
      (report) => setState({ kind: 'done', report }),
      (error) => {
        // Another run may have begun, or the page may have gone.
        if (running.current !== controller) return;
        if (controller.signal.aborted) return setState({ kind: 'cancelled' });
        if (!(error instanceof WebSplatterError)) console.error(error);
        setState({ kind: 'failed', message: error instanceof Error ? error.message : String(error) });
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
    <LabPage
      name="bench"
      title="Benchmark"
      about={
        <>
          The same camera path, size and settings on every device, so that reports can be compared. Each frame
          is culled, sorted and drawn anew, and complete before the next begins. The address can ask for
          others: <code>scene=still-life-small</code>, <code>size=1280x720</code>, <code>frames=50</code>,{' '}
          <code>orbit=360</code>, <code>accuracy=fast</code>.
        </>
      }
    >
      {state.kind === 'running' ? (
        <Progress label={labelOf(state.progress)} done={state.progress.part}>
          <button type="button" data-testid="cancel" onClick={() => running.current?.abort()}>
            Cancel
          </button>
        </Progress>
      ) : (
        <div className="buttons">
          <button type="button" className="primary" data-testid="again" onClick={run}>
            Run again
          </button>
        </div>
      )}
      <p role="status" className="visually-hidden">
        {OUTCOMES[state.kind]}
      </p>
      {state.kind === 'cancelled' && <p className="note">The benchmark was cancelled.</p>}
      {state.kind === 'failed' && (
        <p className="failure" role="alert" data-testid="failure">
          {state.message}
        </p>
      )}
      {state.kind === 'done' && <Result report={state.report} />}
      {state.kind === 'done' && <Comparison report={state.report} />}
    </LabPage>
  );
}

const OUTCOMES: Readonly<Record<BenchmarkState['kind'], string>> = {
  running: 'Measuring',
  done: 'The report is ready',
  failed: 'The benchmark has failed',
  cancelled: 'Cancelled',
};

function labelOf({ label, part }: BenchmarkProgress): string {
  return part === undefined ? label : `${label} · ${Math.round(100 * part)} %`;
}

function Result({ report }: { report: BenchmarkReport }) {
  const { measurement, scene } = report;
  const { gpuMs, wallClockMs, passes, adapter, copyBytesPerSecond, frames } = measurement;
  const stages = timeRows(measurement);
  const [[, ...headings], ...times] = timeTable(measurement);
  const named = times.map(([name, ...cells], row) => [
    <>
      {stages[row].stage && <i className={`swatch ${stages[row].stage}`} aria-hidden="true" />}
      {name}
    </>,
    ...cells,
  ]);
  return (
    <section aria-labelledby="result">
      <h2 id="result">{scene}</h2>
      <p className="headline">
        <strong>{(gpuMs ?? wallClockMs).median.toFixed(2)} ms</strong> a frame in the median
        {gpuMs ? ' on the GPU' : ' by the wall clock'}, {adapter}
      </p>
      {/* The medians of the stages side by side; the table below has the figures. */}
      <div className="bar" aria-hidden="true">
        {stages.map(
          ({ stage, spread }) =>
            stage && <i key={stage} className={stage} style={{ flexGrow: spread.median }} />,
        )}
      </div>
      <CellTable label="Times" testId="times" rows={[[`Of ${frames} frames`, ...headings], ...named]} />
      <p className="muted">{timeNotes(measurement).join(' ')}</p>
      {passes && (
        <details>
          <summary>Passes, each timed by itself</summary>
          <CellTable label="Passes" rows={passTable(passes, copyBytesPerSecond)} wordColumns={2} />
        </details>
      )}
      <dl data-testid="facts">
        {reportFacts(report).map(([name, value]) => (
          <div key={name}>
            <dt>{name}</dt>
            <dd>{value}</dd>
          </div>
        ))}
      </dl>
      <TakeReports
        reports={[
          {
            format: 'JSON',
            text: () => `${JSON.stringify(report, null, 2)}\n`,
            fileName: ['websplatter-bench', scene, adapter, report.madeAt.slice(0, 10)],
          },
          { format: 'text', text: () => reportText(report) },
        ]}
      />
    </section>
  );
}

/** Puts saved reports of other devices, or of this one, beside this report. */
function Comparison({ report }: { report: BenchmarkReport }) {
  const [others, setOthers] = useState<readonly FrameReport[]>([]);
  const [problem, setProblem] = useState('');
  const input = useRef<HTMLInputElement>(null);
  const add = async (files: readonly File[]) => {
    setProblem('');
    try {
      const read = await Promise.all(files.map(async (file) => readReport(await file.text(), file.name)));
      setOthers((before) => [...before, ...read]);
    } catch (error) {
      setProblem(error instanceof Error ? error.message : String(error));
    }
  };
  const columnOf = (other: FrameReport) => {
    const names = differencesOf(report, other);
    return (
      <>
        {other.measurement.adapter}
        {names.length > 0 && <p className="warning">Differs in {names.join(', ')}</p>}
      </>
    );
  };
  return (
    <section aria-labelledby="others">
      <h2 id="others">Compared with other reports</h2>
      <div className="buttons">
        <button type="button" onClick={() => input.current?.click()}>
          Add saved reports
        </button>
        {others.length > 0 && (
          <button type="button" onClick={() => setOthers([])}>
            Remove them
          </button>
        )}
        <input
          ref={input}
          type="file"
          accept=".json,application/json"
          multiple
          hidden
          data-testid="reports"
          onChange={(event) => {
            void add([...(event.target.files ?? [])]);
            // So that choosing the same file again is a change.
            event.target.value = '';
          }}
        />
      </div>
      <p role="status">{problem}</p>
      {others.length > 0 && (
        <CellTable
          label="Medians of all reports"
          testId="compared"
          rows={[['Median ms', 'This report', ...others.map(columnOf)], ...comparedRows([report, ...others])]}
        />
      )}
    </section>
  );
}

/** Passes progress on when it has another label, or a while after the last. */
function paced(show: (state: BenchmarkState) => void): (progress: BenchmarkProgress) => void {
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
