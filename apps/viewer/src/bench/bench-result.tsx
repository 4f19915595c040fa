import type { FrameMeasurement, PassCost } from '@websplatter/core/measure';
import { type BenchReport, benchFacts, TIME_HEADINGS, timeCells, timeRows } from './bench-report.ts';

/** What a benchmark found: the median frame as a bar, the table of times, passes, facts. */
export function BenchResult({ report }: { report: BenchReport }) {
  const { measurement, notes, scene } = report;
  const { median } = measurement.gpuMs ?? measurement.wallClockMs;
  return (
    <section className="bench-result" aria-labelledby="bench-title" data-testid="bench-result">
      <div>
        <h2 id="bench-title">{scene.title}</h2>
        <p className="bench-headline">
          <strong data-testid="bench-median">{median.toFixed(2)} ms</strong>{' '}
          <span>
            a frame in the median{measurement.gpuMs ? ' on the GPU' : ' by the wall clock'},{' '}
            {measurement.adapter}
          </span>
        </p>
      </div>
      {measurement.stageMs && <StageBar stageMs={measurement.stageMs} />}
      <Times measurement={measurement} />
      {notes.map((note) => (
        <p key={note} className="page-note">
          {note}
        </p>
      ))}
      {measurement.passes && <Passes passes={measurement.passes} />}
      <dl className="page-facts" data-testid="bench-facts">
        {benchFacts(report).map(([name, value]) => (
          <FactRow key={name} name={name} value={value} />
        ))}
      </dl>
    </section>
  );
}

function FactRow({ name, value }: { name: string; value: string }) {
  return (
    <>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </>
  );
}

/** The medians of the stages side by side; the table below has the figures. */
function StageBar({ stageMs }: { stageMs: NonNullable<FrameMeasurement['stageMs']> }) {
  return (
    <div className="bench-bar" aria-hidden="true">
      {Object.entries(stageMs).map(([stage, { median }]) => (
        <i key={stage} className={`stage-${stage}`} style={{ flexGrow: median }} />
      ))}
    </div>
  );
}

function Times({ measurement }: { measurement: FrameMeasurement }) {
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: what scrolls by itself must be reachable by keys.
    <section className="page-table" tabIndex={0} aria-label="Times">
      <table data-testid="bench-times">
        <thead>
          <tr>
            <th scope="col">Of {measurement.frames} frames</th>
            {TIME_HEADINGS.map((heading) => (
              <th key={heading} scope="col">
                {heading}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {timeRows(measurement).map(({ name, stage, spread }) => (
            <tr key={name} className={stage ? '' : 'bench-whole'}>
              <th scope="row">
                {stage && <i className={`bench-swatch stage-${stage}`} aria-hidden="true" />}
                {name}
              </th>
              {timeCells(spread).map((cell, column) => (
                <td key={TIME_HEADINGS[column]}>{cell}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

function Passes({ passes }: { passes: readonly PassCost[] }) {
  return (
    <details className="bench-passes">
      <summary>Passes, each timed by itself: the GPU pauses in between, so their sum is more</summary>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: what scrolls by itself must be reachable by keys. */}
      <section className="page-table" tabIndex={0} aria-label="Passes">
        <table>
          <thead>
            <tr>
              <th scope="col">Pass</th>
              <th scope="col">median ms</th>
              <th scope="col">P99 ms</th>
              <th scope="col">GB/s</th>
            </tr>
          </thead>
          <tbody>
            {passes.map(({ part, stage, timeMs, bytesPerSecond }) => (
              <tr key={`${part}/${stage}`}>
                <th scope="row">{stage}</th>
                <td>{timeMs.median.toFixed(3)}</td>
                <td>{timeMs.p99.toFixed(3)}</td>
                <td>{bytesPerSecond === null ? '–' : (bytesPerSecond / 1e9).toFixed(1)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </section>
    </details>
  );
}
