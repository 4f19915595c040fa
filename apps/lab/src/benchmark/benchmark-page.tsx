import { passTable, timeNotes, timeRows, timeTable } from '@websplatter/charts';
import { ACCURACY_PRESETS, WebSplatterError } from '@websplatter/core';
import { builtinScenes } from '@websplatter/scenes';
import { type FormEvent, useCallback, useEffect, useRef, useState } from 'react';
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
import { BENCHMARK_DEFAULTS } from './request.ts';
import { type BenchmarkProgress, runBenchmark } from './run.ts';
import { filesIn } from './scene.ts';

type BenchmarkState =
  | { readonly kind: 'ready' }
  | { readonly kind: 'running'; readonly progress: BenchmarkProgress }
  | { readonly kind: 'done'; readonly report: BenchmarkReport }
  | { readonly kind: 'failed'; readonly message: string }
  | { readonly kind: 'cancelled' };

const STARTING: BenchmarkState = { kind: 'running', progress: { label: 'Starting', part: undefined } };
/** Drawing the progress takes the GPU's time too: it must not be drawn with every frame. */
const PROGRESS_INTERVAL_MS = 500;

/** The benchmark (`?bench`) and its report. The document's `data-state` is its state. */
export default function BenchmarkPage({ query }: { query: URLSearchParams }) {
  const [state, setState] = useState<BenchmarkState>({ kind: 'ready' });
  const [options, setOptions] = useState(query);
  const running = useRef<AbortController | null>(null);
  const run = useCallback((asked: URLSearchParams) => {
    running.current?.abort();
    const controller = new AbortController();
    running.current = controller;
    setState(STARTING);
    setOptions(asked);
    // A link to this page measures the same.
    history.replaceState(history.state, '', `?${asked}`);
    runBenchmark(asked, controller.signal, paced(setState)).then(
      (report) => setState({ kind: 'done', report }),
      (error) => {
        // Another run may have begun, or the page may have gone.
        if (running.current !== controller) return;
        if (controller.signal.aborted) return setState({ kind: 'cancelled' });
        if (!(error instanceof WebSplatterError)) console.error(error);
        setState({ kind: 'failed', message: error instanceof Error ? error.message : String(error) });
      },
    );
  }, []);

  useEffect(
    () => () => {
      const controller = running.current;
      running.current = null;
      controller?.abort();
    },
    [],
  );
  useEffect(() => {
    document.documentElement.dataset.state = state.kind;
  }, [state.kind]);

  return (
    <LabPage
      name="bench"
      title="Benchmark"
      about="The same camera path, size and settings on every device, so that reports can be compared. Each frame is culled, sorted and drawn anew, and complete before the next begins. Keeps this device busy for a while."
    >
      {state.kind === 'running' ? (
        <Progress label={labelOf(state.progress)} done={state.progress.part}>
          <button type="button" data-testid="cancel" onClick={() => running.current?.abort()}>
            Cancel
          </button>
        </Progress>
      ) : (
        <OptionsForm query={options} label={state.kind === 'ready' ? 'Start' : 'Run again'} onStart={run} />
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

/** Options by their names in the address. */
const OPTIONS = [
  ['scene', 'Scene', builtinScenes[0].name],
  ['size', 'Size, px', BENCHMARK_DEFAULTS.size],
  ['frames', 'Frames', BENCHMARK_DEFAULTS.frames],
  ['orbit', 'Angle of the path, degrees', BENCHMARK_DEFAULTS.orbit],
  ['accuracy', 'Accuracy', BENCHMARK_DEFAULTS.accuracy],
] as const;

/** What is measured, as the address asks for it. Empty fields are the defaults, which all devices share. */
function OptionsForm(props: {
  query: URLSearchParams;
  label: string;
  onStart: (asked: URLSearchParams) => void;
}) {
  const { query, label, onStart } = props;
  const files = filesIn(query);
  const start = (event: FormEvent<HTMLFormElement>) => {
    event.preventDefault();
    const asked = new URLSearchParams(query);
    for (const [name, value] of new FormData(event.currentTarget)) {
      if (value === '') asked.delete(name);
      else asked.set(name, String(value));
    }
    onStart(asked);
  };
  return (
    <form className="options" onSubmit={start} data-testid="options">
      {files.length > 0 && <p>Scene: {files.join(', ')}</p>}
      {OPTIONS.filter(([name]) => name !== 'scene' || files.length === 0).map(([name, words, usual]) => (
        <label key={name}>
          <span>{words}</span>
          <input
            name={name}
            defaultValue={query.get(name) ?? ''}
            placeholder={usual}
            list={name === 'scene' || name === 'accuracy' ? `${name}-names` : undefined}
            spellCheck={false}
          />
        </label>
      ))}
      <Names id="scene-names" names={builtinScenes.map(({ name }) => name)} />
      <Names id="accuracy-names" names={Object.keys(ACCURACY_PRESETS)} />
      <button type="submit" className="primary" data-testid="start">
        {label}
      </button>
    </form>
  );
}

function Names({ id, names }: { id: string; names: readonly string[] }) {
  return (
    <datalist id={id}>
      {names.map((name) => (
        <option key={name} value={name} />
      ))}
    </datalist>
  );
}

const OUTCOMES: Readonly<Record<BenchmarkState['kind'], string>> = {
  ready: '',
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
