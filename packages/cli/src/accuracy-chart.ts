import {
  type ErrorTimeChart,
  errorTimeChart,
  frontPath,
  type LabelBox,
  type PlacedPoint,
  POINT_RADIUS_PX,
  placeAllLabels,
} from '@websplatter/charts';
import type { AccuracyPoint, AccuracyTable } from '@websplatter/core/measure';
import { isBase, isInterval, isOfLessDetail } from './accuracy-report.ts';

const WIDTH = 800;
const HEIGHT = 500;
const PLOT: LabelBox = { left: 64, top: 66, right: 776, bottom: 440 };
const MOST_TICKS = { x: 8, y: 8 };
const LINE_PX = 13;
/** Widths of a character: generous averages of proportional fonts. */
const CHARACTER_PX = 6.1;
const BOLD_CHARACTER_PX = 6.9;
/** Combinations of settings have long names: the plot shows letters, the key below the names. */
const KEY_ROW_PX = 16;

const STYLE = `
  svg { color-scheme: light dark; background: #fff; font: 11px system-ui, sans-serif; }
  text { fill: #1f2328; paint-order: stroke; stroke: #fff; stroke-width: 3px; stroke-linejoin: round; } .quiet { fill: #59636e; } .title { font-size: 15px; font-weight: 600; }
  .grid { stroke: #e4e8ec; } .axis { stroke: #8b949e; } .spread { stroke: #8b949e; stroke-width: 1.5; }
  .leader { stroke: #8b949e; stroke-width: .75; } .dot { fill: #fff; stroke: #59636e; stroke-width: 1.5; }
  .front { fill: none; stroke: #0969da; stroke-width: 2; } .dot.onFront { fill: #0969da; stroke: #0969da; }
  .dot.base { stroke: #bc4c00; stroke-width: 3; } .label.onFront { font-weight: 600; fill: #0550ae; }
  .details { fill: none; stroke: #1a7f37; stroke-width: 1.5; stroke-dasharray: 4 3; }
  .dot.detail { stroke: #1a7f37; } .dot.detail.onFront { fill: #1a7f37; }
  @media (prefers-color-scheme: dark) {
    svg { background: #0d1117; } text { fill: #e6edf3; stroke: #0d1117; } .quiet { fill: #9198a1; }
    .grid { stroke: #21262d; } .axis, .spread { stroke: #6e7681; } .leader { stroke: #6e7681; }
    .dot { fill: #0d1117; stroke: #9198a1; } .front { stroke: #58a6ff; }
    .dot.onFront { fill: #58a6ff; stroke: #58a6ff; } .dot.base { stroke: #f0883e; } .label.onFront { fill: #79c0ff; }
    .details, .dot.detail { stroke: #3fb950; } .dot.detail.onFront { fill: #3fb950; }
  }`;

/** Draws error over time as an SVG, 800 px wide and 500 px high or more: accurate up, fast left. */
export function accuracyChart(table: AccuracyTable, scene: string): string {
  const { points } = table;
  const chart = errorTimeChart(points, PLOT, MOST_TICKS);
  const combinations = points.filter(({ name }) => name.includes(', '));
  const letters = new Map(combinations.map((point, i) => [point, String.fromCharCode(65 + i)]));
  const height = HEIGHT + (combinations.length > 0 ? KEY_ROW_PX * combinations.length + 8 : 0);
  const hasDetails = points.some((point) => isOfLessDetail(point, table));
  const byDetail = chart.points
    .filter(({ point }) => hasDetails && (isBase(point, table) || isOfLessDetail(point, table)))
    .sort((a, b) => b.point.splats - a.point.splats);
  const labels = placedNames(chart, letters);
  const { widthPx, heightPx, splats, adapter, frames, timing } = table;
  const details = `${splats.toLocaleString('en')} splats, ${widthPx}×${heightPx} px, ${adapter}`;
  const source = timing === 'gpu-timestamps' ? 'GPU timestamps' : 'wall clock';
  const elements = [
    text(PLOT.left, 24, scene, 'title'),
    text(PLOT.left, 42, `${details}; median of ${frames} frames by ${source}`, 'quiet'),
    ...chart.xTicks.flatMap(({ at, text: ms }) => [
      line(at, PLOT.top, at, PLOT.bottom, 'grid'),
      text(at, PLOT.bottom + 16, ms, 'quiet', 'middle'),
    ]),
    ...chart.yTicks.flatMap(({ at, text: psnrDb }) => [
      line(PLOT.left, at, PLOT.right, at, 'grid'),
      text(PLOT.left - 8, at + 4, psnrDb, 'quiet', 'end'),
    ]),
    ...equalLine(chart.bandBottom),
    line(PLOT.left, PLOT.bottom, PLOT.right, PLOT.bottom, 'axis'),
    line(PLOT.left, PLOT.top, PLOT.left, PLOT.bottom, 'axis'),
    text(
      (PLOT.left + PLOT.right) / 2,
      PLOT.bottom + 34,
      `milliseconds per frame${chart.isLogTime ? ', logarithmic' : ''}`,
      'quiet',
      'middle',
    ),
    `<text class="quiet" text-anchor="middle" transform="translate(18 ${(PLOT.top + PLOT.bottom) / 2}) rotate(-90)">PSNR against the reference, dB</text>`,
    hasDetails ? `<path class="details" d="${linePath(byDetail)}"/>` : '',
    `<path class="front" d="${frontPath(chart.front, round)}"/>`,
    ...labels.map(({ leader }) => (leader ? line(...leader, 'leader') : '')),
    ...chart.points.map(({ lowX, highX, y }) => line(lowX, y, highX, y, 'spread')),
    ...chart.points.map((placed) => dot(placed, table)),
    ...labels.map(({ box, name, isOnFront }) =>
      text(box.left, box.bottom - 3, name, isOnFront ? 'label onFront' : 'label'),
    ),
    ...legend(frames, hasDetails),
    ...[...letters].flatMap(([{ name }, letter], i) => [
      text(PLOT.left + 3, HEIGHT + KEY_ROW_PX * i + 14, letter, 'label'),
      text(PLOT.left + 16, HEIGHT + KEY_ROW_PX * i + 14, name, 'quiet'),
    ]),
  ];
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${WIDTH}" height="${height}" viewBox="0 0 ${WIDTH} ${height}" role="img">`,
    `<title>What accuracy costs in time: ${escaped(scene)}</title>`,
    `<style>${STYLE}\n</style>`,
    ...elements.filter((element) => element !== ''),
    '</svg>',
    '',
  ].join('\n');
}

/** Images equal to the reference have no error in dB: their points lie on a line above the scale. */
function equalLine(bandBottom: number | null): string[] {
  if (bandBottom === null) return [];
  const y = (PLOT.top + bandBottom) / 2;
  return [line(PLOT.left, y, PLOT.right, y, 'grid'), text(PLOT.left - 8, y + 4, 'equal', 'quiet', 'end')];
}

/** Labels of the points: names or letters. Labels of the Pareto front come first and are bold. */
function placedNames({ points, lines }: ErrorTimeChart, letters: ReadonlyMap<AccuracyPoint, string>) {
  const named = [...points]
    .sort((a, b) => Number(b.point.isOnFront) - Number(a.point.isOnFront))
    .map(({ point, x, y }) => {
      const name = letters.get(point) ?? point.name;
      const { isOnFront } = point;
      const width = (isOnFront ? BOLD_CHARACTER_PX : CHARACTER_PX) * name.length;
      return { x, y, name, isOnFront, width, height: LINE_PX };
    });
  return placeAllLabels(named, PLOT, lines).map((placed, i) => ({ ...named[i], ...placed }));
}

function legend(frames: number, hasDetails: boolean): string[] {
  const y = HEIGHT - 12;
  const entry = (x: number, mark: string, label: string) => [mark, text(x + 10, y + 4, label, 'quiet')];
  return [
    ...entry(
      PLOT.left + 6,
      `<circle class="dot onFront" cx="${PLOT.left + 6}" cy="${y}" r="${POINT_RADIUS_PX}"/>`,
      'on the front: nothing is both more accurate and faster',
    ),
    ...entry(
      PLOT.left + 350,
      `<circle class="dot base" cx="${PLOT.left + 350}" cy="${y}" r="${POINT_RADIUS_PX}"/>`,
      'the base',
    ),
    ...entry(
      PLOT.left + 440,
      line(PLOT.left + 430, y, PLOT.left + 444, y, 'spread'),
      isInterval(frames) ? '95 % interval of the median' : 'all that was measured',
    ),
    ...(hasDetails
      ? entry(
          PLOT.left + 626,
          `<path class="dot detail" d="${diamond(PLOT.left + 626, y)}"/>`,
          'fewer splats',
        )
      : []),
  ];
}

function dot({ point, x, y }: PlacedPoint, table: AccuracyTable): string {
  const isDetail = isOfLessDetail(point, table);
  const names = ['dot', isDetail && 'detail', point.isOnFront && 'onFront', isBase(point, table) && 'base'];
  const { total } = point.timeMs;
  const tip = `${point.name}: ${isEqual(point) ? 'equal' : `${point.error.psnrDb.toFixed(1)} dB`}, ${total.median.toFixed(2)} ms`;
  const title = `<title>${escaped(tip)}</title>`;
  const classes = `class="${names.filter(Boolean).join(' ')}"`;
  return isDetail
    ? `<path ${classes} d="${diamond(x, y)}">${title}</path>`
    : `<circle ${classes} cx="${round(x)}" cy="${round(y)}" r="${POINT_RADIUS_PX}">${title}</circle>`;
}

function diamond(x: number, y: number): string {
  const reach = POINT_RADIUS_PX + 1;
  return `M${round(x - reach)} ${round(y)}l${reach} ${-reach}l${reach} ${reach}l${-reach} ${reach}z`;
}

function linePath(places: readonly { readonly x: number; readonly y: number }[]): string {
  return `M${places.map(({ x, y }) => `${round(x)} ${round(y)}`).join('L')}`;
}

function isEqual({ error }: AccuracyPoint): boolean {
  return error.psnrDb === Number.POSITIVE_INFINITY;
}

function line(x1: number, y1: number, x2: number, y2: number, name: string): string {
  return `<line class="${name}" x1="${round(x1)}" y1="${round(y1)}" x2="${round(x2)}" y2="${round(y2)}"/>`;
}

function text(x: number, y: number, content: string, name: string, anchor = 'start'): string {
  const place = `x="${round(x)}" y="${round(y)}"${anchor === 'start' ? '' : ` text-anchor="${anchor}"`}`;
  return `<text class="${name}" ${place}>${escaped(content)}</text>`;
}

function escaped(content: string): string {
  return content
    .replaceAll('&', '&amp;')
    .replaceAll('<', '&lt;')
    .replaceAll('>', '&gt;')
    .replaceAll('"', '&quot;');
}

function round(value: number): number {
  return Math.round(10 * value) / 10;
}
