import type { AccuracyPoint } from '@websplatter/core/measure';
import { type KeyboardEvent, memo, type RefObject, useEffect, useMemo, useRef, useState } from 'react';
import {
  type Box,
  type ChartLayout,
  chartLayout,
  type PlacedPoint,
  placeLabels,
  ticksIn,
} from './chart-layout.ts';

const HEIGHT_PX = 230;
/** Room around the plot for axes with values and titles. */
const MARGIN_PX = { left: 50, right: 8, top: 8, bottom: 40 };
const AREA_HEIGHT_PX = HEIGHT_PX - MARGIN_PX.top - MARGIN_PX.bottom;
const AREA_INSET = [MARGIN_PX.top, MARGIN_PX.right, MARGIN_PX.bottom, MARGIN_PX.left]
  .map((px) => `${px}px`)
  .join(' ');
/** Least distance between two values on an axis. */
const TICK_SPACE_PX = { x: 44, y: 30 };
/** Must equal the font in the style sheet. */
const LABEL_FONT = '11px system-ui, sans-serif';
const LABEL_HEIGHT_PX = 14;

/** Positions in the plot, CSS px, y down. */
interface Scales {
  readonly widthPx: number;
  xOf(ms: number): number;
  yOf(db: number): number;
}

/** Chart of error against time, with the Pareto front as a step line. Points are buttons. */
export function ErrorTimeChart({
  points,
  current,
  onPick,
  onLook,
}: {
  points: readonly AccuracyPoint[];
  /** Index of the point with the current settings; −1 if there is none. */
  current: number;
  /** Called when a point is clicked or Enter is pressed on it. */
  onPick: (index: number) => void;
  /** Called with the point under the pointer or with focus; null when there is none any more. */
  onLook: (index: number | null) => void;
}) {
  const root = useRef<HTMLDivElement>(null);
  const widthPx = useWidthPx(root);
  const layout = useMemo(() => chartLayout(points), [points]);
  const scales = useMemo(() => scalesOf(layout, widthPx), [layout, widthPx]);
  const { placed } = layout;
  /** Index of the Tab stop; arrow keys move between points in order of time. */
  const stop = placed.some(({ index }) => index === current) ? current : placed[0]?.index;
  const moveFocus = (event: KeyboardEvent, at: number) => {
    const by = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    // Arrow keys that bubble would turn the scene.
    event.stopPropagation();
    const next = placed[(at + by + placed.length) % placed.length].index;
    root.current?.querySelector<HTMLElement>(`[data-index="${next}"]`)?.focus();
  };
  return (
    // biome-ignore lint/a11y/useSemanticElements: a fieldset would bring a layout of its own.
    <div ref={root} className="chart" role="group" aria-label="Error against time" data-testid="chart">
      <Axes layout={layout} scales={scales} />
      <div className="chart-area" style={{ inset: AREA_INSET }}>
        {placed.map(({ index, name, label, words, isOnFront, ...point }, at) => (
          <button
            key={index}
            type="button"
            className={isOnFront ? 'chart-point on-front' : 'chart-point'}
            style={{ left: scales.xOf(point.xMs), top: scales.yOf(point.yDb) }}
            data-testid="accuracy-point"
            data-index={index}
            data-name={name}
            aria-label={`${label}: ${words}`}
            aria-pressed={index === current}
            tabIndex={index === stop ? 0 : -1}
            onClick={() => onPick(index)}
            onKeyDown={(event) => moveFocus(event, at)}
            onPointerEnter={() => onLook(index)}
            onFocus={() => onLook(index)}
            onPointerLeave={() => onLook(null)}
            onBlur={() => onLook(null)}
          >
            <Interval point={point} scales={scales} />
          </button>
        ))}
        <Labels layout={layout} scales={scales} />
      </div>
    </div>
  );
}

function Interval({
  point: { xMs, lowMs, highMs },
  scales: { xOf },
}: {
  point: Pick<PlacedPoint, 'xMs' | 'lowMs' | 'highMs'>;
  scales: Scales;
}) {
  return <i style={{ left: `calc(50% + ${xOf(lowMs) - xOf(xMs)}px)`, width: xOf(highMs) - xOf(lowMs) }} />;
}

/** Grid lines at round values, the band of points that equal the reference, and the front. */
const Axes = memo(function Axes({
  layout: { frontLine, xRange, yRange, equalFromDb },
  scales: { widthPx, xOf, yOf },
}: {
  layout: ChartLayout;
  scales: Scales;
}) {
  const xTicks = ticksIn(xRange, Math.max(1, Math.floor(widthPx / TICK_SPACE_PX.x)));
  // The band has no values in decibels.
  const yTicks = ticksIn(yRange, Math.floor(AREA_HEIGHT_PX / TICK_SPACE_PX.y)).filter(
    ({ value }) => equalFromDb === null || value < equalFromDb,
  );
  const bandPx = equalFromDb === null ? 0 : yOf(equalFromDb);
  const front = frontLine.map(({ xMs, yDb }, i) =>
    i > 0 ? `H${xOf(xMs)}V${yOf(yDb)}` : `M${xOf(xMs)} ${yOf(yDb)}`,
  );
  return (
    // Hidden from screen readers: the points have the same information.
    <svg width="100%" height={HEIGHT_PX} aria-hidden="true">
      <g transform={`translate(${MARGIN_PX.left} ${MARGIN_PX.top})`}>
        <rect className="chart-band" width={widthPx} height={bandPx} />
        {xTicks.map(({ value, text }) => (
          <g key={text} transform={`translate(${xOf(value)} ${AREA_HEIGHT_PX})`}>
            <path d={`M0 0v${-AREA_HEIGHT_PX}`} />
            <text y={15} textAnchor="middle">
              {text}
            </text>
          </g>
        ))}
        {yTicks.map(({ value, text }) => (
          <g key={text} transform={`translate(0 ${yOf(value)})`}>
            <path d={`M0 0h${widthPx}`} />
            <text x={-4} y={4} textAnchor="end">
              {text}
            </text>
          </g>
        ))}
        {equalFromDb !== null && (
          <text x={-4} y={bandPx / 2 + 4} textAnchor="end">
            identical
          </text>
        )}
        <path className="chart-front" d={front.join('')} />
        <text x={widthPx / 2} y={AREA_HEIGHT_PX + 34} textAnchor="middle">
          milliseconds per frame
        </text>
        <text transform={`translate(-38 ${AREA_HEIGHT_PX / 2}) rotate(-90)`} textAnchor="middle">
          PSNR in dB, higher is better
        </text>
      </g>
    </svg>
  );
});

/** Labels beside their points, if there is room. */
const Labels = memo(function Labels({ layout, scales }: { layout: ChartLayout; scales: Scales }) {
  const { placed } = layout;
  const labelled = [...placed].sort((a, b) => b.importance - a.importance);
  const boxes = placeLabels(
    labelled.map(({ xMs, yDb, label }) => ({
      x: scales.xOf(xMs),
      y: scales.yOf(yDb),
      width: textWidthPx(label),
      height: LABEL_HEIGHT_PX,
    })),
    { left: 2, top: 0, width: scales.widthPx - 4, height: AREA_HEIGHT_PX },
    linesOf(layout, scales),
  );
  return labelled.map(({ index, label }, i) => {
    const box = boxes[i];
    if (!box) return null;
    return (
      // Hidden from screen readers: the point has the same name.
      <span key={index} className="chart-label" style={{ left: box.left, top: box.top }} aria-hidden="true">
        {label}
      </span>
    );
  });
});

/** Bounding boxes of the front's steps and of the points' intervals. */
function linesOf({ placed, frontLine }: ChartLayout, { xOf, yOf }: Scales): Box[] {
  const lineBox = (fromMs: number, fromDb: number, toMs: number, toDb: number): Box => ({
    left: xOf(fromMs) - 1,
    top: Math.min(yOf(fromDb), yOf(toDb)) - 1,
    width: xOf(toMs) - xOf(fromMs) + 2,
    height: Math.abs(yOf(toDb) - yOf(fromDb)) + 2,
  });
  const steps = frontLine.slice(1).flatMap(({ xMs, yDb }, i) => {
    const from = frontLine[i];
    return [lineBox(from.xMs, from.yDb, xMs, from.yDb), lineBox(xMs, from.yDb, xMs, yDb)];
  });
  return [...steps, ...placed.map(({ lowMs, highMs, yDb }) => lineBox(lowMs, yDb, highMs, yDb))];
}

/** @param chartPx width of the chart including its axes. */
function scalesOf({ xRange, yRange }: ChartLayout, chartPx: number): Scales {
  const widthPx = Math.max(1, chartPx - MARGIN_PX.left - MARGIN_PX.right);
  return {
    widthPx,
    xOf: (ms) => ((ms - xRange[0]) / (xRange[1] - xRange[0])) * widthPx,
    yOf: (db) => ((yRange[1] - db) / (yRange[1] - yRange[0])) * AREA_HEIGHT_PX,
  };
}

/** The current width of an element, CSS pixels; 0 before its layout. */
function useWidthPx(element: RefObject<HTMLElement | null>): number {
  const [widthPx, setWidthPx] = useState(0);
  useEffect(() => {
    if (!element.current) return;
    const resize = new ResizeObserver(([{ contentRect }]) => setWidthPx(contentRect.width));
    resize.observe(element.current);
    return () => resize.disconnect();
  }, [element]);
  return widthPx;
}

let context: CanvasRenderingContext2D | null = null;

function textWidthPx(text: string): number {
  context ??= document.createElement('canvas').getContext('2d');
  if (!context) return 0;
  context.font = LABEL_FONT;
  return context.measureText(text).width + 2;
}
