import { standardDeviation } from '@websplatter/core/measure';
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
  spreadOf,
} from '../runner/report.ts';
import type { SceneFormat } from '../runner/scenes.ts';
import type { Report, Round, Row, SceneReport } from './report.ts';

/** Ratios are to this peer, or else to the first that draws. */
const BASE = 'websplatter';
/** This project, by any adapter and options. */
const OWN = /^websplatter(?:[-?]|$)/;

/** The rows that a row is compared with. */
interface Others {
  readonly base: Row | undefined;
  /** The floor that draws by the same API. */
  readonly floor: Row | undefined;
  /** The other project that loads the scene in the least time. */
  readonly quickest: Row | undefined;
}

interface Column {
  readonly head: string;
  cell(row: Row, others: Others): string;
}

const loadMsOf = ({ loaded }: Round) => loaded.loadMs;
/** Most GPU time that this project in three.js may take above both its floors, ms. */
const MOST_ABOVE_MS = 0.3;
const lastOf = ({ rounds }: Row) => rounds.at(-1);

const NAME_COLUMNS: readonly Column[] = [
  { head: 'peer', cell: ({ peer }) => peer },
  { head: 'version', cell: ({ version }) => version ?? NONE },
];
const FETCH_COLUMN: Column = {
  head: '× fetch',
  cell: (row, { floor }) => (row.isFloor || !floor ? NONE : ratioCell(row, floor, loadMsOf)),
};
const WAY_COLUMNS: readonly Column[] = [
  {
    head: 'first splats',
    cell: ({ rounds }) => medianCell(rounds.map(({ loaded }) => loaded.firstSplatsMs)),
  },
  {
    head: 'longest task',
    cell: ({ rounds }) => medianCell(rounds.map(({ loaded }) => loaded.longestTaskMs)),
  },
];
const MEMORY_COLUMNS: readonly Column[] = [
  {
    head: 'GPU MB',
    cell: (row) => {
      const { gpuBytes, gpuPeakBytes } = lastOf(row)?.state ?? {};
      return gpuBytes === undefined ? NONE : `${megabytes(gpuBytes)} / ${megabytes(gpuPeakBytes!)}`;
    },
  },
  {
    head: 'JS MB',
    cell: (row) => {
      const heap = lastOf(row)?.heap;
      return heap ? megabytes(heap.jsBytes) : NONE;
    },
  },
  { head: 'PSNR dB', cell: ({ pictures }) => psnrCell(pictures.map(({ psnrDb }) => psnrDb)) },
];

const COLUMNS: readonly Column[] = [
  ...NAME_COLUMNS,
  { head: 'load', cell: ({ rounds }) => medianCell(rounds.map(loadMsOf)) },
  FETCH_COLUMN,
  ...WAY_COLUMNS,
  { head: 'correct frame', cell: (row) => spreadCell(timesOf(row, 'correctMs'), 2) },
  {
    head: '×',
    cell: (row, { base }) => (row.isFloor || !base ? NONE : ratioCell(row, base, medianCorrectMs)),
  },
  { head: 'turn', cell: (row) => spreadCell(timesOf(row, 'turnMs'), 2) },
  {
    head: '± %',
    cell: (row) => {
      const turnMs = timesOf(row, 'turnMs');
      const meanMs = turnMs.reduce((sum, ms) => sum + ms, 0) / turnMs.length;
      return turnMs.length > 0 ? ((100 * standardDeviation(turnMs)) / meanMs).toFixed(0) : NONE;
    },
  },
  {
    head: 'GPU',
    cell: (row) => spreadCell(timesOf(row, 'gpuMs'), 2),
  },
  { head: 'GPU frame', cell: (row) => spreadCell(frameMsOf(row.rounds), 2) },
  {
    head: 'orders',
    cell: (row) => {
      const measured = lastOf(row)?.measured;
      return measured ? String(measured.orders ?? 'each') : NONE;
    },
  },
  ...MEMORY_COLUMNS,
];

/** Where loads alone are measured. */
const LOAD_COLUMNS: readonly Column[] = [
  ...NAME_COLUMNS,
  { head: 'load', cell: ({ rounds }) => spreadCell(rounds.map(loadMsOf), 0) },
  FETCH_COLUMN,
  {
    head: '× quickest',
    cell: (row, { quickest }) => (row.isFloor || !quickest ? NONE : ratioCell(row, quickest, loadMsOf)),
  },
  ...WAY_COLUMNS,
  ...MEMORY_COLUMNS,
];

/**
 * A table for each scene, with one of its passes if these were measured, and one of all formats if
 * loads alone were measured.
 */
export function reportParts({ scenes, widthPx, heightPx, isLoads }: Report): ReportPart[] {
  const parts = scenes.flatMap((scene) => [
    partOf(scene, `${widthPx}×${heightPx}`, isLoads),
    ...passesOf(scene),
  ]);
  return isLoads ? [...parts, { heading: 'Loads of all formats', rows: loadsOf(scenes), notes: [] }] : parts;
}

/** Meaning of the columns. */
export function reportLegend(report: Report): string[] {
  const { pictureWidthPx, pictureHeightPx, frames, jumps, wait, isFromFile, isLoads } = report;
  const source = isFromFile ? 'dropped file' : 'address';
  return [
    `Times are ms, median / P99 over all rounds, from the change of the camera to the end of the GPU's work (WebGPU by "${wait}").`,
    `load: from the ${source} to the first correct frame; × fetch: beside the floor of the same API, which throws the bytes away.`,
    `first splats: on the way there. longest task: of the page's thread meanwhile; 0 below 50 ms.`,
    ...(isLoads
      ? [
          '× quickest: beside the other project that takes the least by its median, the least and the most of any round.',
        ]
      : [
          `correct frame: in the right order, after each of ${jumps} jumps; ×: its median beside the base's, the least and the most of any round.`,
          `turn: ${frames} frames once around; ± %: their standard deviation; orders: how many were made in it, where frames do not make their own.`,
          `GPU: of one frame of a further turn, by timestamps around each submission of WebGPU.`,
          `GPU frame, with --passes: of one frame of a further turn, submitted without waiting, from the end of the one before to its own end.`,
        ]),
    `GPU MB: what the page held at the end / at most, by the API's calls. JS MB: after a garbage collection.`,
    `PSNR, where pictures are taken: ${pictureWidthPx}×${pictureHeightPx} against float64, 8 bits, median and least over the cameras; a peer that leaves splats out has less.`,
  ];
}

/** Formats a report as Markdown that can also be read as it is. */
export function reportText(report: Report): string {
  const parts = reportParts(report).flatMap(({ heading, rows, notes }) => [
    `### ${heading}`,
    '',
    ...markdownTable(rows, 2),
    '',
    ...notes.map((note) => `- ${note}`),
    '',
  ]);
  return [...reportFacts(report), '', ...parts, ...reportLegend(report), ''].join('\n');
}

function partOf(
  { scene, format, fileBytes, splats, shDegree, rows }: SceneReport,
  size: string,
  isLoads: boolean,
): ReportPart {
  const columns = isLoads ? LOAD_COLUMNS : COLUMNS;
  const readers = rows.filter(({ isReader }) => isReader);
  const base =
    rows.find(({ peer }) => peer === BASE) ?? rows.find(({ isFloor, rounds }) => !isFloor && rounds.length);
  const quickest = quickestOf(rows);
  const cells = readers.map((row) => {
    const others = { base, floor: floorOf(row, rows), quickest };
    return columns.map(({ cell }) => cell(row, others));
  });
  const notes = rows.flatMap((row) => [
    ...(row.isReader ? [] : [`${row.peer} does not read ${nameOf(format)}`]),
    ...row.rounds.slice(0, 1).map(({ loaded }) => `${row.peer}: ${loaded.api}, ${loaded.note}`),
    ...aboveNotes(row, rows),
    ...problemNotes(row),
  ]);
  const file = `${nameOf(format)}, ${megabytes(fileBytes)} MB`;
  return {
    heading: `${scene}: ${file}, ${splats.toLocaleString('en')} splats, spherical harmonics of degree ${shDegree}, ${size}`,
    rows: [columns.map(({ head }) => head), ...cells],
    notes,
  };
}

/** Which passes a frame of each peer has, and what they take. */
function passesOf({ scene, rows }: SceneReport): ReportPart[] {
  const lines = rows.flatMap(({ peer, rounds }) => {
    const frames = rounds.flatMap(({ measured }) => measured?.byPass?.passes ?? []);
    const names = [...new Set(frames.flat().map(({ name }) => name))];
    return names.map((pass) => {
      const times = frames.map((frame) => frame.filter(({ name }) => name === pass));
      const frameMs = times.map((some) => some.reduce((sum, { ms }) => sum + ms, 0));
      const each = times.reduce((sum, some) => sum + some.length, 0) / frames.length;
      return [peer, pass, each.toFixed(each % 1 ? 1 : 0), spreadCell(frameMs, 3)];
    });
  });
  if (lines.length === 0) return [];
  return [
    { heading: `${scene}: passes of a frame`, rows: [['peer', 'pass', '×', 'ms'], ...lines], notes: [] },
  ];
}

/** How much a frame inside three.js takes above a frame on a canvas and three's own together. */
function aboveNotes(row: Row, rows: readonly Row[]): string[] {
  const [, options] = /^websplatter-three(.*)$/.exec(row.peer) ?? [];
  const named = (name: string) => rows.find(({ peer }) => peer === name);
  const canvas = named(BASE);
  const floor = named(`floor-three${options}`);
  if (options === undefined || !canvas || !floor) return [];
  const aboveMs = row.rounds.flatMap((round) => {
    const [own, ...others] = [row, canvas, floor].map(({ rounds }) =>
      spreadOf(frameMsOf(rounds.filter((each) => each.round === round.round))),
    );
    return own && others.every(Boolean)
      ? [others.reduce((left, other) => left - other!.median, own.median)]
      : [];
  });
  if (aboveMs.length === 0) return [];
  const { median } = spreadOf(aboveMs)!;
  const range = `${Math.min(...aboveMs).toFixed(2)}–${Math.max(...aboveMs).toFixed(2)}`;
  return [
    `${row.peer}: its median GPU frame is ${median.toFixed(2)} ms (${range}) above those of ${canvas.peer} and ${floor.peer} together; ${median <= MOST_ABOVE_MS ? 'within' : 'ABOVE'} the ${MOST_ABOVE_MS} ms aimed at`,
  ];
}

function frameMsOf(rounds: readonly Round[]): number[] {
  return rounds.flatMap(({ measured }) => measured?.byPass?.frameMs ?? []);
}

function nameOf({ name, variant }: SceneFormat): string {
  return variant ? `${name} ${variant}` : name;
}

/** The floor that draws by the same API. */
function floorOf(row: Row, rows: readonly Row[]): Row | undefined {
  const apiOf = ({ rounds }: Row) => rounds[0]?.loaded.api;
  return rows.find((each) => each.isFloor && apiOf(each) === apiOf(row));
}

function quickestOf(rows: readonly Row[]): Row | undefined {
  const medianOf = ({ rounds }: Row) => spreadOf(rounds.map(loadMsOf))!.median;
  return rows
    .filter(({ peer, isFloor, rounds }) => !isFloor && !OWN.test(peer) && rounds.length > 0)
    .reduce<Row | undefined>(
      (best, row) => (best && medianOf(best) <= medianOf(row) ? best : row),
      undefined,
    );
}

/** The medians of all scenes and peers. */
function loadsOf(scenes: readonly SceneReport[]): string[][] {
  const peers = [...new Set(scenes.flatMap(({ rows }) => rows.map(({ peer }) => peer)))];
  const lines = scenes.map(({ scene, format, fileBytes, rows }) => {
    const cells = peers.map((peer) =>
      medianCell(rows.filter((row) => row.peer === peer).flatMap(({ rounds }) => rounds.map(loadMsOf))),
    );
    return [scene, nameOf(format), megabytes(fileBytes), ...cells];
  });
  return [['load', 'format', 'MB', ...peers], ...lines];
}

/** Over all rounds. */
function timesOf({ rounds }: Row, of: 'correctMs' | 'turnMs' | 'gpuMs'): number[] {
  return rounds.flatMap(({ measured }) => measured?.[of] ?? []);
}

function medianCorrectMs({ measured }: Round): number {
  return spreadOf(measured!.correctMs)!.median;
}

function megabytes(bytes: number): string {
  return (bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0);
}
