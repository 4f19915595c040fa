import type { AccuracyPoint } from '@websplatter/core/measure';
import { formatBytes, formatCount, formatDb, formatMs, formatSplats } from '@websplatter/kit/format';
import { useState } from 'react';
import { useStore } from 'zustand';
import { setAccuracy } from '../engine/edit-picture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { isSameAccuracy } from '../state/accuracy.ts';
import type { MeasuredAccuracy } from '../state/measured.ts';
import { describeMeasured } from '../ui/accuracy-words.ts';
import { ErrorTimeChart } from './error-time-chart.tsx';

/** The newest measured table, as a chart and as a sortable table to choose from. */
export function MeasuredResults({
  store,
  viewer,
  measured,
}: PanelProps & { readonly measured: MeasuredAccuracy }) {
  const [looked, setLooked] = useState<number | null>(null);
  const accuracy = useStore(store, (state) => state.accuracy);
  const isStale = useStore(store, (state) => state.imageId !== measured.imageId);
  const isRunning = useStore(store, (state) => state.measuring?.of === 'accuracy');
  const { table } = measured;
  const current = table.points.findIndex(({ settings }) => isSameAccuracy(settings, accuracy));
  const pick = (index: number) => setAccuracy({ store, viewer }, table.points[index].settings);
  const shown = table.points[looked ?? current];
  return (
    <div className="results" data-testid="results" data-stale={isStale}>
      <ErrorTimeChart points={table.points} current={current} onPick={pick} onLook={setLooked} />
      {shown ? <Details point={shown} /> : <p className="details">The chosen setting was not measured.</p>}
      <PointTable points={table.points} current={current} onPick={pick} />
      <Circumstances measured={measured} isRunning={isRunning} />
    </div>
  );
}

const steps = (error: number) => (255 * error).toFixed(1);

/** The figures of one point, with the confidence interval of its time. */
function Details({ point }: { point: AccuracyPoint }) {
  const { error, timeMs, rasterizers, bytes, notes } = point;
  const { total, preprocess, sort, rasterize } = timeMs;
  const stages = [preprocess, sort, rasterize].map((spread) => (spread ? formatMs(spread.median) : null));
  return (
    <div className="details" data-testid="point-details">
      <p>
        <b>{describeMeasured(point)}</b>
      </p>
      <p>
        {error.maxError === 0
          ? 'Identical to the reference.'
          : `${formatDb(error.psnrDb)} dB · largest error ${steps(error.maxError)} of 255 · 99.9 % of pixels under ${steps(error.p999Error)} · SSIM ${error.ssim.toFixed(4)}`}
      </p>
      <p>
        Median {formatMs(total.median)} ms ({formatMs(total.low)}–{formatMs(total.high)})
        {!stages.includes(null) && ` · ${stages.join(' + ')} ms by stage`} · drawn by{' '}
        {rasterizers.join(' and ')} · {formatBytes(bytes)}
      </p>
      {notes.map((note) => (
        <p key={note}>{note}</p>
      ))}
    </div>
  );
}

/** Columns of the table of measured settings. */
const POINT_COLUMNS = ['name', 'psnr', 'time'] as const;
type PointColumn = (typeof POINT_COLUMNS)[number];

interface PointOrder {
  readonly by: PointColumn;
  readonly isDescending: boolean;
}

/** The most accurate first. */
export const FIRST_ORDER: PointOrder = { by: 'psnr', isDescending: true };

/** The order after a click on a column's header: best first; a second click reverses it. */
export function orderAfter(order: PointOrder, by: PointColumn): PointOrder {
  return order.by === by ? { by, isDescending: !order.isDescending } : { by, isDescending: by === 'psnr' };
}

/** Indices of `points` in this order. Ties are ordered by time. */
export function sortedPoints(
  points: readonly AccuracyPoint[],
  { by, isDescending }: PointOrder,
): readonly number[] {
  const sign = isDescending ? -1 : 1;
  return points
    .map((_, index) => index)
    .sort((a, b) => {
      const [first, second] = [points[a], points[b]];
      return sign * COMPARE[by](first, second) || COMPARE.time(first, second);
    });
}

const COMPARE: Readonly<Record<PointColumn, (a: AccuracyPoint, b: AccuracyPoint) => number>> = {
  name: (a, b) => describeMeasured(a).localeCompare(describeMeasured(b), 'en', { numeric: true }),
  // Equal images have infinite PSNR, whose difference is NaN.
  psnr: (a, b) => (a.error.psnrDb === b.error.psnrDb ? 0 : a.error.psnrDb - b.error.psnrDb),
  time: (a, b) => a.timeMs.total.median - b.timeMs.total.median,
};

const COLUMN_TITLES: Readonly<Record<PointColumn, string>> = {
  name: 'Setting',
  psnr: 'PSNR (dB)',
  time: 'Time (ms)',
};

function PointTable({
  points,
  current,
  onPick,
}: {
  points: readonly AccuracyPoint[];
  current: number;
  onPick: (index: number) => void;
}) {
  const [order, setOrder] = useState(FIRST_ORDER);
  const sorting = order.isDescending ? 'descending' : 'ascending';
  return (
    <table data-testid="point-table">
      <thead>
        <tr>
          {POINT_COLUMNS.map((column) => (
            <th key={column} scope="col" aria-sort={order.by === column ? sorting : undefined}>
              <button
                type="button"
                data-testid={`sort-${column}`}
                onClick={() => setOrder(orderAfter(order, column))}
              >
                {COLUMN_TITLES[column]}
              </button>
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {sortedPoints(points, order).map((index) => (
          <PointRow
            key={points[index].name}
            point={points[index]}
            isCurrent={index === current}
            onPick={() => onPick(index)}
          />
        ))}
      </tbody>
    </table>
  );
}

function PointRow({
  point,
  isCurrent,
  onPick,
}: {
  point: AccuracyPoint;
  isCurrent: boolean;
  onPick: () => void;
}) {
  const { name, error, timeMs, isOnFront } = point;
  const words = describeMeasured(point);
  return (
    <tr className={isOnFront ? 'on-front' : undefined}>
      <th scope="row">
        <button type="button" aria-pressed={isCurrent} onClick={onPick}>
          {words}
          {words !== name && <code>{name}</code>}
        </button>
      </th>
      <td>{formatDb(error.psnrDb)}</td>
      <td>{formatMs(timeMs.total.median)}</td>
    </tr>
  );
}

/** Device and method of a measurement, and the reasons why it is inexact. */
function Circumstances({ measured, isRunning }: { measured: MeasuredAccuracy; isRunning: boolean }) {
  const { table, isCutShort } = measured;
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
    ...(isCutShort && !isRunning ? [`Cancelled after ${formatCount(table.points.length)} settings.`] : []),
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
