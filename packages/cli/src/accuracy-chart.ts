import type { LabelBox } from '@websplatter/charts';
import type { AccuracyPoint, AccuracyTable } from '@websplatter/core/measure';
import { isBase, isInterval, isOfLessDetail } from './accuracy-report.ts';
import { placeLabels } from './label-placement.ts';

const WIDTH = 800;
const HEIGHT = 500;
const PLOT: LabelBox = { left: 64, top: 66, right: 776, bottom: 440 };
/** Images equal to the reference have no error in dB: their points lie above the scale. */
const EQUAL_Y = PLOT.top + 18;
const SCALE_TOP = PLOT.top + 48;
const DOT_RADIUS = 4;
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
  const x = timeScale(points);
  const y = errorScale(points);
  const placed = points.map((point) => ({
    point,
    x: x.at(point.timeMs.total.median),
    y: y.at(point.error.psnrDb),
  }));
  const combinations = points.filter(({ name }) => name.includes(', '));
  const letters = new Map(combinations.map((point, i) => [point, String.fromCharCode(65 + i)]));
  const height = HEIGHT + (combinations.length > 0 ? KEY_ROW_PX * combinations.length + 8 : 0);
  const front = placed.filter(({ point }) => point.isOnFront).sort((a, b) => a.x - b.x);
  const hasDetails = points.some((point) => isOfLessDetail(point, table));
  const byDetail = placed
    .filter(({ point }) => hasDetails && (isBase(point, table) || isOfLessDetail(point, table)))
    .sort((a, b) => b.point.splats - a.point.splats);
  const labels = placeLabels(
    placed.map(({ point, x, y }) => ({
      x,
      y,
      text: letters.get(point) ?? point.name,
      isFirst: point.isOnFront,
    })),
    PLOT,
    DOT_RADIUS,
    [
      ...placed.map(({ point: { timeMs }, y }) =>
        thinBox(x.at(timeMs.total.low), y, x.at(timeMs.total.high), y),
      ),
      ...front.flatMap((from, i) => {
        const to = front[i + 1] ?? { x: PLOT.right, y: from.y };
        return [thinBox(from.x, from.y, to.x, from.y), thinBox(to.x, from.y, to.x, to.y)];
      }),
    ],
  );
  const { widthPx, heightPx, splats, adapter, frames, timing } = table;
  const details = `${splats.toLocaleString('en')} splats, ${widthPx}×${heightPx} px, ${adapter}`;
  const source = timing === 'gpu-timestamps' ? 'GPU timestamps' : 'wall clock';
  const elements = [
    text(PLOT.left, 24, scene, 'title'),
    text(PLOT.left, 42, `${details}; median of ${frames} frames by ${source}`, 'quiet'),
    ...x.ticks.flatMap((ms) => [
      line(x.at(ms), PLOT.top, x.at(ms), PLOT.bottom, 'grid'),
      text(x.at(ms), PLOT.bottom + 16, `${ms}`, 'quiet', 'middle'),
    ]),
    ...y.ticks.flatMap((psnrDb) => [
      line(PLOT.left, y.at(psnrDb), PLOT.right, y.at(psnrDb), 'grid'),
      text(PLOT.left - 8, y.at(psnrDb) + 4, `${psnrDb}`, 'quiet', 'end'),
    ]),
    ...(points.some(isEqual)
      ? [
          line(PLOT.left, EQUAL_Y, PLOT.right, EQUAL_Y, 'grid'),
          text(PLOT.left - 8, EQUAL_Y + 4, 'equal', 'quiet', 'end'),
        ]
      : []),
    line(PLOT.left, PLOT.bottom, PLOT.right, PLOT.bottom, 'axis'),
    line(PLOT.left, PLOT.top, PLOT.left, PLOT.bottom, 'axis'),
    text(
      (PLOT.left + PLOT.right) / 2,
      PLOT.bottom + 34,
      `milliseconds per frame${x.isLog ? ', logarithmic' : ''}`,
      'quiet',
      'middle',
    ),
    `<text class="quiet" text-anchor="middle" transform="translate(18 ${(PLOT.top + PLOT.bottom) / 2}) rotate(-90)">PSNR against the reference, dB</text>`,
    hasDetails ? `<path class="details" d="${linePath(byDetail)}"/>` : '',
    `<path class="front" d="${stepPath(front)}"/>`,
    ...labels.map(({ leader }) => (leader ? line(...leader, 'leader') : '')),
    ...placed.map(({ point: { timeMs }, y }) =>
      line(x.at(timeMs.total.low), y, x.at(timeMs.total.high), y, 'spread'),
    ),
    ...placed.map(({ point, x, y }) => dot(point, x, y, table)),
    ...labels.map(({ x, y, text: name, isFirst }) => text(x, y, name, isFirst ? 'label onFront' : 'label')),
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

function legend(frames: number, hasDetails: boolean): string[] {
  const y = HEIGHT - 12;
  const entry = (x: number, mark: string, label: string) => [mark, text(x + 10, y + 4, label, 'quiet')];
  return [
    ...entry(
      PLOT.left + 6,
      `<circle class="dot onFront" cx="${PLOT.left + 6}" cy="${y}" r="${DOT_RADIUS}"/>`,
      'on the front: nothing is both more accurate and faster',
    ),
    ...entry(
      PLOT.left + 350,
      `<circle class="dot base" cx="${PLOT.left + 350}" cy="${y}" r="${DOT_RADIUS}"/>`,
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

function dot(point: AccuracyPoint, x: number, y: number, table: AccuracyTable): string {
  const isDetail = isOfLessDetail(point, table);
  const names = ['dot', isDetail && 'detail', point.isOnFront && 'onFront', isBase(point, table) && 'base'];
  const { total } = point.timeMs;
  const tip = `${point.name}: ${isEqual(point) ? 'equal' : `${point.error.psnrDb.toFixed(1)} dB`}, ${total.median.toFixed(2)} ms`;
  const title = `<title>${escaped(tip)}</title>`;
  const classes = `class="${names.filter(Boolean).join(' ')}"`;
  return isDetail
    ? `<path ${classes} d="${diamond(x, y)}">${title}</path>`
    : `<circle ${classes} cx="${round(x)}" cy="${round(y)}" r="${DOT_RADIUS}">${title}</circle>`;
}

function diamond(x: number, y: number): string {
  const reach = DOT_RADIUS + 1;
  return `M${round(x - reach)} ${round(y)}l${reach} ${-reach}l${reach} ${reach}l${-reach} ${reach}z`;
}

function linePath(places: readonly { readonly x: number; readonly y: number }[]): string {
  return `M${places.map(({ x, y }) => `${round(x)} ${round(y)}`).join('L')}`;
}

/** Path of the front: flat up to the next point, then up. */
function stepPath(front: readonly { readonly x: number; readonly y: number }[]): string {
  const steps = front.map(({ x, y }, i) =>
    i === 0 ? `M${round(x)} ${round(y)}` : `H${round(x)}V${round(y)}`,
  );
  return `${steps.join('')}H${PLOT.right}`;
}

/** A box around a horizontal or vertical line. */
function thinBox(x1: number, y1: number, x2: number, y2: number): LabelBox {
  return {
    left: Math.min(x1, x2) - 1,
    top: Math.min(y1, y2) - 1,
    right: Math.max(x1, x2) + 1,
    bottom: Math.max(y1, y2) + 1,
  };
}

interface Scale {
  readonly at: (value: number) => number;
  readonly ticks: readonly number[];
}

function timeScale(points: readonly AccuracyPoint[]): Scale & { readonly isLog: boolean } {
  const low = Math.min(...points.map(({ timeMs }) => timeMs.total.low));
  const high = Math.max(...points.map(({ timeMs }) => timeMs.total.high));
  const isLog = low > 0 && high / low > 6;
  const project = isLog ? Math.log : (value: number) => value;
  const [from, to] = [project(low), project(high)];
  const margin = 0.06 * (to - from || Math.abs(to) || 1);
  const span = to - from + 2 * margin;
  const at = (value: number) =>
    PLOT.left + ((project(value) - from + margin) / span) * (PLOT.right - PLOT.left);
  const isInside = (value: number) => at(value) >= PLOT.left && at(value) <= PLOT.right;
  return { at, ticks: (isLog ? logTicks(low, high) : evenTicks(low, high, 8)).filter(isInside), isLog };
}

function errorScale(points: readonly AccuracyPoint[]): Scale {
  const finite = points.map(({ error }) => error.psnrDb).filter(Number.isFinite);
  const [low, high] = finite.length > 0 ? [Math.min(...finite), Math.max(...finite)] : [40, 60];
  const [from, to] = [5 * Math.floor((low - 1) / 5), 5 * Math.ceil((high + 1) / 5)];
  const at = (psnrDb: number) =>
    psnrDb === Number.POSITIVE_INFINITY
      ? EQUAL_Y
      : PLOT.bottom - ((psnrDb - from) / (to - from)) * (PLOT.bottom - SCALE_TOP);
  return { at, ticks: evenTicks(from, to, 8) };
}

/** Returns about `count` round numbers from `low` to `high`. */
function evenTicks(low: number, high: number, count: number): number[] {
  const rough = (high - low || 1) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((factor) => factor * power >= rough) ?? 10);
  const first = Math.ceil(low / step);
  const last = Math.floor(high / step);
  return Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

function logTicks(low: number, high: number): number[] {
  const powers = Array.from(
    { length: Math.ceil(Math.log10(high)) - Math.floor(Math.log10(low)) + 1 },
    (_, i) => 10 ** (Math.floor(Math.log10(low)) + i),
  );
  return powers.flatMap((power) => [1, 2, 5].map((factor) => Number((factor * power).toPrecision(12))));
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
