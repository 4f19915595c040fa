import type { Report, Round, Row, SceneReport } from './report.ts';
import { type Spread, spreadOf } from './spread.ts';

const HEADS = [
  'peer',
  'version',
  'load',
  '× fetch',
  'first splats',
  'longest task',
  'correct frame',
  '×',
  'turn',
  '± %',
  'orders',
  'GPU MB',
  'JS MB',
  'PSNR dB',
] as const;
const NONE = '–';
/** Ratios are to this peer, or else to the first that draws. */
const BASE = 'websplatter';

/** Formats a report as Markdown that can also be read as it is. */
export function reportText(report: Report): string {
  const { widthPx, heightPx, pictureWidthPx, pictureHeightPx, frames, jumps, wait, isFromFile } = report;
  const source = isFromFile ? 'dropped file' : 'address';
  return [
    `${report.date}, commit ${report.commit ?? 'unknown'}: ${report.command}`,
    `${report.adapter ?? 'no adapter'}; ${report.browser}; ${report.machine}`,
    '',
    ...report.scenes.flatMap((scene) => [...sceneLines(scene, `${widthPx}×${heightPx}`), '']),
    `Times are ms, median / P99 over all rounds, from the change of the camera to the end of the GPU's work (WebGPU by "${wait}").`,
    `load: from the ${source} to the first correct frame; × fetch: beside the floor of the same API, which throws the bytes away.`,
    `first splats: on the way there. longest task: of the page's thread meanwhile; 0 below 50 ms.`,
    `correct frame: in the right order, after each of ${jumps} jumps; ×: its median beside the base's, the least and the most of any round.`,
    `turn: ${frames} frames once around; ± %: their standard deviation; orders: how many were made in it, where frames do not make their own.`,
    `GPU MB: what the page held at the end / at most, by the API's calls. JS MB: after a garbage collection.`,
    `PSNR, where pictures are taken: ${pictureWidthPx}×${pictureHeightPx} against float64, 8 bits, median and least over the cameras; a peer that leaves splats out has less.`,
    '',
  ].join('\n');
}

function sceneLines({ scene, splats, shDegree, rows }: SceneReport, size: string): string[] {
  const base =
    rows.find(({ peer }) => peer === BASE) ?? rows.find(({ isFloor, rounds }) => !isFloor && rounds.length);
  const cells = rows.map((row) => cellsOf(row, base, floorOf(row, rows)));
  const notes = rows.flatMap(({ peer, rounds, failures }) => [
    ...(rounds.length ? [`${peer}: ${rounds[0].loaded.api}, ${rounds[0].loaded.note}`] : []),
    ...new Set(failures.map((failure) => `${peer} FAILED: ${failure}`)),
    ...new Set(
      rounds.flatMap(({ state }) => state.problems.map((problem) => `${peer} complains: ${problem}`)),
    ),
  ]);
  return [
    `### ${scene}: ${splats.toLocaleString('en')} splats, spherical harmonics of degree ${shDegree}, ${size}`,
    '',
    ...markdownTable([HEADS, ...cells]),
    '',
    ...notes.map((note) => `- ${note}`),
  ];
}

/** The floor that draws by the same API. */
function floorOf(row: Row, rows: readonly Row[]): Row | undefined {
  const apiOf = ({ rounds }: Row) => rounds[0]?.loaded.api;
  return rows.find((each) => each.isFloor && apiOf(each) === apiOf(row));
}

function cellsOf(row: Row, base: Row | undefined, floor: Row | undefined): string[] {
  const { rounds, pictures } = row;
  const times = (of: (round: Round) => readonly number[]) => rounds.flatMap(of);
  const correctMs = times(({ measured }) => measured.correctMs);
  const turn = spreadOf(times(({ measured }) => measured.turnMs));
  const last = rounds.at(-1);
  return [
    row.peer,
    row.version ?? NONE,
    spreadCell(
      times(({ loaded }) => [loaded.loadMs]),
      0,
      { hasTail: false },
    ),
    row.isFloor || !floor ? NONE : ratioCell(row, floor, ({ loaded }) => loaded.loadMs),
    spreadCell(
      times(({ loaded }) => [loaded.firstSplatsMs]),
      0,
      { hasTail: false },
    ),
    spreadCell(
      times(({ loaded }) => [loaded.longestTaskMs]),
      0,
      { hasTail: false },
    ),
    spreadCell(correctMs, 2),
    row.isFloor || !base ? NONE : ratioCell(row, base, medianCorrectMs),
    spreadText(turn, 2),
    turn ? (100 * turn.deviation).toFixed(0) : NONE,
    last ? String(last.measured.orders ?? 'each') : NONE,
    last ? `${megabytes(last.state.gpuBytes)} / ${megabytes(last.state.gpuPeakBytes)}` : NONE,
    last ? megabytes(last.heap.jsBytes) : NONE,
    psnrCell(pictures.map(({ psnrDb }) => psnrDb)),
  ];
}

function spreadCell(values: readonly number[], digits: number, { hasTail = true } = {}): string {
  return spreadText(spreadOf(values), digits, { hasTail });
}

function spreadText(spread: Spread | null, digits: number, { hasTail = true } = {}): string {
  if (!spread) return NONE;
  const { median, p99 } = spread;
  return hasTail ? `${median.toFixed(digits)} / ${p99.toFixed(digits)}` : median.toFixed(digits);
}

function medianCorrectMs({ measured }: Round): number {
  return spreadOf(measured.correctMs)!.median;
}

/** Ratio of what rounds took, and how far they differ, in the rounds in which both peers were measured. */
function ratioCell(row: Row, base: Row, roundMs: (round: Round) => number): string {
  const ratios = row.rounds.flatMap((own) => {
    const other = base.rounds.find(({ round }) => round === own.round);
    return other ? [roundMs(own) / roundMs(other)] : [];
  });
  if (ratios.length === 0) return NONE;
  const [middle, least, most] = [spreadOf(ratios)!.median, Math.min(...ratios), Math.max(...ratios)];
  return `${middle.toFixed(2)} (${least.toFixed(2)}–${most.toFixed(2)})`;
}

function psnrCell(values: readonly number[]): string {
  const spread = spreadOf(values);
  return spread ? `${spread.median.toFixed(1)} (${Math.min(...values).toFixed(1)})` : NONE;
}

function megabytes(bytes: number): string {
  return (bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0);
}

/** The first two columns hold words, the others figures. */
function markdownTable(rows: readonly (readonly string[])[]): string[] {
  const isWord = (column: number) => column < 2;
  const widths = rows[0].map((_, column) => Math.max(...rows.map((row) => row[column].length), 3));
  const line = (cells: readonly string[]) => `| ${cells.join(' | ')} |`;
  const padded = rows.map((row) =>
    line(
      row.map((cell, column) =>
        isWord(column) ? cell.padEnd(widths[column]) : cell.padStart(widths[column]),
      ),
    ),
  );
  const rule = line(
    widths.map((width, column) => (isWord(column) ? '-'.repeat(width) : `${'-'.repeat(width - 1)}:`)),
  );
  return [padded[0], rule, ...padded.slice(1)];
}
