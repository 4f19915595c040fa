import {
  type ErrorTimeChart as Chart,
  errorTimeChart,
  frontPath,
  type PlacedPoint,
  placeLabels,
} from '@websplatter/charts';
import { ACCURACY_PRESETS } from '@websplatter/core';
import type { AccuracyPoint } from '@websplatter/core/measure';
import { formatMs, formatPsnr } from '@websplatter/kit/format';
import { type KeyboardEvent, memo, type RefObject, useEffect, useMemo, useRef, useState } from 'react';
import { describeMeasured } from '../ui/accuracy-words.ts';

const HEIGHT_PX = 230;
/** Room around the plot for axes with values and titles. */
const MARGIN_PX = { left: 68, right: 8, top: 8, bottom: 40 };
const AREA_HEIGHT_PX = HEIGHT_PX - MARGIN_PX.top - MARGIN_PX.bottom;
const AREA_INSET = [MARGIN_PX.top, MARGIN_PX.right, MARGIN_PX.bottom, MARGIN_PX.left]
  .map((px) => `${px}px`)
  .join(' ');
/** Least distance between two values on an axis. */
const TICK_SPACE_PX = { x: 44, y: 30 };
/** Must equal the font in the style sheet. */
const LABEL_FONT = '11px system-ui, sans-serif';
const LABEL_HEIGHT_PX = 14;

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
  const chartPx = useWidthPx(root);
  const widthPx = Math.max(1, chartPx - MARGIN_PX.left - MARGIN_PX.right);
  const chart = useMemo(() => chartOf(points, widthPx), [points, widthPx]);
  const placed = chart.points;
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
      <Axes chart={chart} widthPx={widthPx} />
      <div className="chart-area" style={{ inset: AREA_INSET }}>
        {placed.map(({ index, point, x, y, lowX, highX }, at) => (
          <button
            key={index}
            type="button"
            className={point.isOnFront ? 'chart-point on-front' : 'chart-point'}
            style={{ left: x, top: y }}
            data-testid="accuracy-point"
            data-index={index}
            data-name={point.name}
            aria-label={`${describeMeasured(point)}: ${figuresOf(point)}`}
            aria-pressed={index === current}
            tabIndex={index === stop ? 0 : -1}
            onClick={() => onPick(index)}
            onKeyDown={(event) => moveFocus(event, at)}
            onPointerEnter={() => onLook(index)}
            onFocus={() => onLook(index)}
            onPointerLeave={() => onLook(null)}
            onBlur={() => onLook(null)}
          >
            <i style={{ left: `calc(50% + ${lowX - x}px)`, width: highX - lowX }} />
          </button>
        ))}
        <Labels chart={chart} widthPx={widthPx} />
      </div>
    </div>
  );
}

function chartOf(points: readonly AccuracyPoint[], widthPx: number): Chart {
  return errorTimeChart(
    points,
    { left: 0, top: 0, right: widthPx, bottom: AREA_HEIGHT_PX },
    {
      x: Math.max(1, Math.floor(widthPx / TICK_SPACE_PX.x)),
      y: Math.floor(AREA_HEIGHT_PX / TICK_SPACE_PX.y),
    },
  );
}

/** A point's error and time, as text. */
function figuresOf({ error, timeMs }: AccuracyPoint): string {
  return `${formatPsnr(error.psnrDb)}, ${formatMs(timeMs.total.median)} ms`;
}

/** Grid lines at round values, the band of points that equal the reference, and the front. */
const Axes = memo(function Axes({
  chart: { front, xTicks, yTicks, isLogTime, bandBottom },
  widthPx,
}: {
  chart: Chart;
  widthPx: number;
}) {
  return (
    // Hidden from screen readers: the points have the same information.
    <svg width="100%" height={HEIGHT_PX} aria-hidden="true">
      <g transform={`translate(${MARGIN_PX.left} ${MARGIN_PX.top})`}>
        <rect className="chart-band" width={widthPx} height={bandBottom ?? 0} />
        {xTicks.map(({ at, text }) => (
          <g key={text} transform={`translate(${at} ${AREA_HEIGHT_PX})`}>
            <path d={`M0 0v${-AREA_HEIGHT_PX}`} />
            <text y={15} textAnchor="middle">
              {text}
            </text>
          </g>
        ))}
        {yTicks.map(({ at, text }) => (
          <g key={text} transform={`translate(0 ${at})`}>
            <path d={`M0 0h${widthPx}`} />
            <text x={-4} y={4} textAnchor="end">
              {text}
            </text>
          </g>
        ))}
        {bandBottom !== null && (
          <text x={-4} y={bandBottom / 2 + 4} textAnchor="end">
            identical
          </text>
        )}
        <path className="chart-front" d={frontPath(front)} />
        <text x={widthPx / 2} y={AREA_HEIGHT_PX + 34} textAnchor="middle">
          {isLogTime ? 'milliseconds per frame, logarithmic' : 'milliseconds per frame'}
        </text>
        <text transform={`translate(-56 ${AREA_HEIGHT_PX / 2}) rotate(-90)`} textAnchor="middle">
          PSNR in dB, higher is better
        </text>
      </g>
    </svg>
  );
});

/** Labels beside their points, if there is room. */
const Labels = memo(function Labels({ chart, widthPx }: { chart: Chart; widthPx: number }) {
  const labelled = [...chart.points]
    .sort((a, b) => importanceOf(b) - importanceOf(a))
    .map(({ index, point, x, y }) => ({ index, label: describeMeasured(point), x, y }));
  const boxes = placeLabels(
    labelled.map(({ label, x, y }) => ({ x, y, width: textWidthPx(label), height: LABEL_HEIGHT_PX })),
    { left: 2, top: 0, right: widthPx - 2, bottom: AREA_HEIGHT_PX },
    chart.lines,
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

/** Labels with a higher importance are placed first: presets, then points of the front. */
function importanceOf({ point }: PlacedPoint): number {
  return (Object.hasOwn(ACCURACY_PRESETS, point.name) ? 2 : 0) + (point.isOnFront ? 1 : 0);
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
