import { timeSpread } from '@websplatter/core/measure';
import {
  markdownTable,
  medianCell,
  NONE,
  problemNotes,
  psnrCell,
  type ReportPart,
  ratioCell,
  reportFacts,
  spreadCell,
} from '../runner/report.ts';
import type { StreamRound, StreamRow, StreamsReport } from './report.ts';

interface Column {
  readonly head: string;
  /** @param base the first peer, which ratios are beside. */
  cell(row: StreamRow, base: StreamRow): string;
}

const firstPictureMs = ({ watched }: StreamRound) => watched.firstPictureMs;
const completeMs = ({ streamed }: StreamRound) => streamed.completeMs;
const turnMs = ({ measured }: StreamRound) => timeSpread(measured.turnMs).median;

function median(rounds: readonly StreamRound[], of: (round: StreamRound) => number, unit = 1): string {
  return medianCell(
    rounds.map((round) => of(round) / unit),
    unit === 1 ? 0 : 1,
  );
}

const COLUMNS: readonly Column[] = [
  { head: 'peer', cell: ({ peer }) => peer },
  { head: 'version', cell: ({ version }) => version ?? NONE },
  { head: 'first picture', cell: ({ rounds }) => median(rounds, firstPictureMs) },
  { head: '×', cell: (row, base) => ratioCell(row, base, firstPictureMs) },
  {
    head: 'dB',
    cell: ({ rounds }) => median(rounds, ({ watched }) => watched.firstPsnrDb).replace('Infinity', '∞'),
  },
  { head: 'MB', cell: ({ rounds }) => median(rounds, ({ bytes }) => bytes.firstPicture, 1e6) },
  { head: 'complete', cell: ({ rounds }) => median(rounds, completeMs) },
  { head: '×', cell: (row, base) => ratioCell(row, base, completeMs) },
  { head: 'MB', cell: ({ rounds }) => median(rounds, ({ bytes }) => bytes.complete, 1e6) },
  { head: 'longest task', cell: ({ rounds }) => median(rounds, ({ streamed }) => streamed.longestTaskMs) },
  {
    head: 'turn',
    cell: ({ rounds }) =>
      spreadCell(
        rounds.flatMap(({ measured }) => measured.turnMs),
        2,
      ),
  },
  { head: '×', cell: (row, base) => ratioCell(row, base, turnMs) },
  { head: 'orders', cell: ({ rounds }) => String(rounds.at(-1)?.measured.orders ?? 'each') },
  {
    head: 'GPU',
    cell: ({ rounds }) =>
      spreadCell(
        rounds.flatMap(({ measured }) => measured.gpuMs),
        2,
      ),
  },
  { head: 'MB', cell: ({ rounds }) => median(rounds, ({ bytes }) => bytes.turn, 1e6) },
  { head: 'splats', cell: ({ rounds }) => String(rounds.at(-1)?.state.figures.splats ?? NONE) },
  { head: 'GPU MB', cell: ({ rounds }) => median(rounds, ({ state }) => state.gpuBytes, 1e6) },
  { head: 'JS MB', cell: ({ rounds }) => median(rounds, ({ heap }) => heap.jsBytes, 1e6) },
  { head: 'own dB', cell: ({ pictures }) => psnrCell(pictures.map(({ ownPsnrDb }) => ownPsnrDb)) },
  { head: 'true dB', cell: ({ pictures }) => psnrCell(pictures.flatMap(({ psnrDb }) => psnrDb ?? [])) },
  {
    head: 'finest dB',
    cell: ({ pictures }) => psnrCell(pictures.flatMap(({ finestPsnrDb }) => finestPsnrDb ?? [])),
  },
];

/** The table of all peers. */
export function reportPart(report: StreamsReport): ReportPart {
  const { size, maxSplats, poolBytes, bitsPerSecond, latencyMs, rows } = report;
  const cells = rows.map((row) => COLUMNS.map(({ cell }) => cell(row, rows[0])));
  const notes = rows.flatMap((row) => [
    ...row.rounds
      .slice(0, 1)
      .map(({ streamed }) => `${row.peer}: ${row.format}, ${streamed.api}, ${streamed.note}`),
    ...row.rounds.flatMap(({ round, bytes: { rest, complete } }) =>
      rest > complete
        ? `${row.peer}, round ${round + 1}: ${rest - complete} bytes came when it was complete`
        : [],
    ),
    ...problemNotes(row),
  ]);
  const rate = bitsPerSecond === null ? 'no limit of rate' : `${bitsPerSecond / 1e6} Mbit/s`;
  return {
    heading: `${size.widthPx}×${size.heightPx}, at most ${maxSplats.toLocaleString('en')} splats and ${poolBytes / 2 ** 20} MiB, ${rate}, ${latencyMs} ms to an answer`,
    rows: [COLUMNS.map(({ head }) => head), ...cells],
    notes,
  };
}

/** Meaning of the columns. */
export function reportLegend({ wait, frames, pictureSize, rows }: StreamsReport): string[] {
  return [
    `Times are ms, medians over all rounds, or median / P99 of all frames; × is beside ${rows[0].peer}, round by round (least–most).`,
    'first picture: to the end of the first frame with splats, and how near it is to the complete one, both an eighth as wide; in a browser of its own, because looking for it takes the page’s time.',
    'complete: to the end of the frame after which nothing came any more, for a second.',
    'MB: bytes of the scene sent by the first picture, by the complete one, and by the end of the turns.',
    `turn: ${frames} frames once around, each to the end of the GPU's work (WebGPU by "${wait}"). orders: made in it, where frames do not make their own.`,
    'GPU: of one frame of a further turn, by timestamps. GPU MB, JS MB: when complete, by the API’s calls, and after a garbage collection.',
    'splats: as the renderer counts them: in sight, or all that it has chosen.',
    `PSNR at ${pictureSize.widthPx}×${pictureSize.heightPx}, median and least over the cameras. own: against the same renderer without a budget, everything loaded. true, finest: the picture and that one against float64.`,
  ];
}

/** Formats a report as Markdown that can also be read as it is. */
export function reportText(report: StreamsReport): string {
  const { heading, rows, notes } = reportPart(report);
  return [
    ...reportFacts(report),
    '',
    `### ${heading}`,
    '',
    ...markdownTable(rows, 2),
    '',
    ...notes.map((note) => `- ${note}`),
    '',
    ...reportLegend(report),
    '',
  ].join('\n');
}
