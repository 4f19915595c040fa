import type { AccuracyWish } from '@websplatter/core';
import type { AccuracyPoint } from '@websplatter/core/measure';
import { type FormEvent, useEffect, useId, useRef, useState } from 'react';
import { useStore } from 'zustand';
import type { AccuracyProps } from '../accuracy/accuracy-settings.tsx';
import type { MeasuredAccuracy } from '../state/store.ts';
import { isSameAccuracy } from '../words/accuracy-text.ts';
import { formatBytes, formatCount, formatMs, formatSplats } from '../words/format.ts';
import { AccuracyChart } from './accuracy-chart.ts';
import type { AccuracySweep } from './accuracy-measurement.ts';
import { formatDb } from './chart-layout.ts';
import { Runner, timingCautions } from './runner.tsx';

/** Measures what each setting costs and buys in the picture that stands, and lets one be chosen by that. */
export function MeasureForm({ store, viewer, sweep }: AccuracyProps & { readonly sweep: AccuracySweep }) {
  const measured = useStore(store, (state) => state.measured);
  const choice = useStore(store, (state) => state.choice);
  const hasWish = useStore(store, (state) => state.wish !== null);
  return (
    <div className="measure-form">
      <Runner
        store={store}
        of="accuracy"
        label={measured ? 'Measure again' : 'Measure this view'}
        about={
          measured ? null : 'Draws this view with every setting, and tells what each costs and what it buys.'
        }
        onStart={() => void (hasWish ? sweep.choose() : sweep.measure())}
        onCancel={() => sweep.cancel()}
      />
      {choice && (
        <p className="choice" role="status" data-testid="choice" data-met={choice.isMet}>
          {choice.why}
        </p>
      )}
      {measured && <Results store={store} viewer={viewer} measured={measured} />}
      <WishForm store={store} viewer={viewer} />
    </div>
  );
}

function Results({ store, viewer, measured }: AccuracyProps & { readonly measured: MeasuredAccuracy }) {
  const [looked, setLooked] = useState<number | null>(null);
  const accuracy = useStore(store, (state) => state.accuracy);
  const isStale = useStore(store, (state) => state.pictureId !== measured.pictureId);
  const { table } = measured;
  const current = table.points.findIndex(({ settings }) => isSameAccuracy(settings, accuracy));
  const pick = (index: number) => viewer.setAccuracy(table.points[index].settings);
  const shown = table.points[looked ?? current];
  return (
    <div className="results" data-testid="results" data-stale={isStale}>
      {isStale && <p className="stale">Measured of another view, scene or size: measure again.</p>}
      <Chart table={table} current={current} onPick={pick} onLook={setLooked} />
      {shown ? <Details point={shown} /> : <p className="details">The chosen setting was not measured.</p>}
      <PointTable points={table.points} current={current} onPick={pick} />
      <Circumstances measured={measured} />
    </div>
  );
}

function Chart({
  table,
  current,
  onPick,
  onLook,
}: {
  table: MeasuredAccuracy['table'];
  current: number;
  onPick: (index: number) => void;
  onLook: (index: number | null) => void;
}) {
  const root = useRef<HTMLDivElement>(null);
  const chart = useRef<AccuracyChart | null>(null);
  const events = useRef({ onPick, onLook });
  events.current = { onPick, onLook };
  useEffect(() => {
    if (!root.current) return;
    const made = new AccuracyChart(root.current, {
      onPick: (index) => events.current.onPick(index),
      onLook: (index) => events.current.onLook(index),
    });
    chart.current = made;
    return () => {
      chart.current = null;
      made.destroy();
    };
  }, []);
  useEffect(() => chart.current?.show({ points: table.points, current }), [table, current]);
  return (
    // biome-ignore lint/a11y/useSemanticElements: a fieldset would bring its own layout into uPlot's.
    <div ref={root} className="chart" role="group" aria-label="Error against time" data-testid="chart" />
  );
}

/** The figures of one point, with the interval that its time is known to. */
function Details({ point }: { point: AccuracyPoint }) {
  const { name, error, timeMs, bytes, notes } = point;
  const { total, preprocess, sort, rasterize } = timeMs;
  const stages = [preprocess, sort, rasterize].map((spread) => (spread ? formatMs(spread.median) : null));
  return (
    <div className="details" data-testid="point-details">
      <p>
        <b>{name}</b>
      </p>
      <p>
        {formatDb(error.psnrDb)} dB · largest error {(255 * error.maxError).toFixed(1)} of 255 · 99.9 % under{' '}
        {(255 * error.p999Error).toFixed(1)} · SSIM {error.ssim.toFixed(4)}
      </p>
      <p>
        {formatMs(total.median)} ms ({formatMs(total.low)}–{formatMs(total.high)})
        {!stages.includes(null) && ` · ${stages.join(' + ')} ms by stage`} · {formatBytes(bytes)}
      </p>
      {notes.map((note) => (
        <p key={note}>{note}</p>
      ))}
    </div>
  );
}

function PointTable({
  points,
  current,
  onPick,
}: {
  points: readonly AccuracyPoint[];
  current: number;
  onPick: (index: number) => void;
}) {
  return (
    <table data-testid="point-table">
      <thead>
        <tr>
          <th scope="col">Setting</th>
          <th scope="col">dB</th>
          <th scope="col">ms</th>
        </tr>
      </thead>
      <tbody>
        {points.map(({ name, error, timeMs, isOnFront }, index) => (
          <tr key={name} className={isOnFront ? 'on-front' : undefined}>
            <th scope="row">
              <button type="button" aria-pressed={index === current} onClick={() => onPick(index)}>
                {name}
              </button>
            </th>
            <td>{formatDb(error.psnrDb)}</td>
            <td>{formatMs(timeMs.total.median)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** On what and how the table was measured, and what keeps it from being exact. */
function Circumstances({ measured }: { measured: MeasuredAccuracy }) {
  const { table, isSoftware } = measured;
  const { adapter, timing, widthPx, heightPx, splats, views, frames, reference, notes } = table;
  const facts = [
    adapter,
    timing === 'gpu-timestamps' ? 'GPU timestamps' : 'wall clock',
    `${widthPx} × ${heightPx}`,
    formatSplats(splats),
    views === 1 ? 'this view' : `${formatCount(views)} views, the worst counts`,
    `${formatCount(frames)} frames each`,
  ];
  const cautions = [
    ...timingCautions(isSoftware, timing),
    ...reference.notes.map((note) => `Reference: ${note}`),
    ...notes,
  ];
  return (
    <div className="circumstances" data-testid="circumstances">
      <p>{facts.join(' · ')}</p>
      {cautions.map((caution) => (
        <p key={caution}>{caution}</p>
      ))}
    </div>
  );
}

type WishKind = 'minPsnrDb' | 'maxFrameMs';

/** The number of a wish as a field has it, by its name. */
function textsOf(wish: AccuracyWish | null): Partial<Record<WishKind, string>> {
  return Object.fromEntries(Object.entries(wish ?? {}).map(([name, value]) => [name, String(value)]));
}

/** A result instead of settings. */
function WishForm({ store, viewer }: AccuracyProps) {
  const id = useId();
  const isBusy = useStore(store, (state) => state.sweep !== null || state.scene === null);
  const { wish } = store.getState();
  const [kind, setKind] = useState<WishKind>(wish && 'maxFrameMs' in wish ? 'maxFrameMs' : 'minPsnrDb');
  const [amounts, setAmounts] = useState({ minPsnrDb: '45', maxFrameMs: '8', ...textsOf(wish) });
  const value = Number(amounts[kind]);
  const submit = (event: FormEvent) => {
    event.preventDefault();
    viewer.setWish(kind === 'minPsnrDb' ? { minPsnrDb: value } : { maxFrameMs: value });
  };
  return (
    <form className="wish" onSubmit={submit} aria-labelledby={`${id}-title`} data-testid="wish">
      <h3 id={`${id}-title`}>Choose settings for me</h3>
      <div className="wish-row">
        <select
          aria-label="Wish"
          value={kind}
          data-testid="wish-kind"
          onChange={({ target }) => setKind(target.value as WishKind)}
        >
          <option value="minPsnrDb">At least</option>
          <option value="maxFrameMs">At most</option>
        </select>
        <input
          type="number"
          aria-label={kind === 'minPsnrDb' ? 'Decibels' : 'Milliseconds'}
          min={kind === 'minPsnrDb' ? 1 : 0.1}
          step="any"
          required
          value={amounts[kind]}
          data-testid="wish-value"
          onChange={({ target }) => setAmounts({ ...amounts, [kind]: target.value })}
        />
        <span aria-hidden="true">{kind === 'minPsnrDb' ? 'dB' : 'ms'}</span>
        <button
          type="submit"
          className="text-button outlined"
          disabled={isBusy || !(value > 0)}
          data-testid="wish-submit"
        >
          Keep
        </button>
      </div>
      <p>
        Measures eight views around this one, of which the worst counts; a software adapter this one alone.
        What you open later is measured as well.
      </p>
    </form>
  );
}
