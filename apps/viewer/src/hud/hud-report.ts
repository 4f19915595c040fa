import type { EngineMemory, FrameStatistics, TimedPass } from '@websplatter/core';
import type { ViewerState } from '../state/store.ts';
import { summarize } from '../state/time-summary.ts';
import type { Side } from './frame-recorder.ts';
import { drawnOf, memoryByGroup, PASSES, sideOf } from './hud-figures.ts';

/** The panel's data when a report is made. */
export interface Recorded {
  readonly state: ViewerState;
  readonly frames: Readonly<Record<Side, readonly FrameStatistics[]>>;
  readonly renderMs: readonly number[];
  readonly ownMs: readonly number[];
  readonly memory: EngineMemory | null;
  readonly maxBufferBytes: number | null;
  readonly maxBindingBytes: number | null;
  /** The browser, as it calls itself. */
  readonly program: string;
  readonly madeAt: Date;
}

/** Everything that the largest size shows, and the frames that it follows from. */
function hudReport(recorded: Recorded) {
  const { state, memory, maxBufferBytes, maxBindingBytes } = recorded;
  const { scene, widthPx, heightPx } = state;
  return {
    madeAt: recorded.madeAt.toISOString(),
    program: recorded.program,
    adapter: state.adapterLabel,
    scene: scene && { title: scene.title, splats: scene.splats },
    image: { widthPx, heightPx },
    sides: {
      left: sideReport('left', recorded),
      ...(state.comparison?.kind === 'split' && { right: sideReport('right', recorded) }),
    },
    cpu: { renderCallsMs: summarize(recorded.renderMs), figuresMs: summarize(recorded.ownMs) },
    memory: memory && {
      totalBytes: memory.totalBytes,
      peakBytes: memory.peakBytes,
      groupBytes: memoryByGroup(memory),
      maxBufferBytes,
      maxBindingBytes,
    },
  };
}

/** Unknown values are null. */
export function jsonReport(recorded: Recorded): string {
  return JSON.stringify(hudReport(recorded), null, 2);
}

function sideReport(side: Side, { state, frames }: Recorded) {
  const of = (name: 'preprocessMs' | 'sortMs' | 'rasterizeMs' | 'totalMs') =>
    summarize(frames[side].map(({ timing }) => timing[name]));
  const { accuracy, detail } = drawnOf(side, state);
  return {
    accuracy,
    detail,
    rasterizer: sideOf(side, state).rasterizer,
    stagesMs: {
      preprocess: of('preprocessMs'),
      sort: of('sortMs'),
      rasterize: of('rasterizeMs'),
      total: of('totalMs'),
    },
    frames: frames[side],
  };
}

/** Columns of a frame besides its passes; an empty cell is not known. */
const COLUMNS: readonly (readonly [string, (frame: FrameStatistics) => string | number | null])[] = [
  ['frame', ({ frame }) => frame],
  ['source', ({ timing }) => timing.source],
  ['preprocess_ms', ({ timing }) => timing.preprocessMs],
  ['sort_ms', ({ timing }) => timing.sortMs],
  ['rasterize_ms', ({ timing }) => timing.rasterizeMs],
  ['total_ms', ({ timing }) => timing.totalMs],
  ['wall_clock_ms', ({ timing }) => timing.wallClockMs],
  ['rasterizer', ({ rasterizer }) => rasterizer],
  ['loaded_splats', ({ loadedSplats }) => loadedSplats],
  ['candidate_splats', ({ candidateSplats }) => candidateSplats],
  ['visible_splats', ({ visibleSplats }) => visibleSplats],
  ['cut_error_px', ({ cutErrorPx }) => cutErrorPx],
  ['tile_pairs', ({ tilePairs }) => tilePairs],
];

/** A row per frame, oldest first, both sides of a split image one after the other. */
export function csvReport({ state, frames }: Recorded): string {
  const passes = PASSES.map(([pass]) => pass);
  const header = ['side', ...COLUMNS.map(([name]) => name), ...passes.map(passColumn)];
  const sides: readonly Side[] = state.comparison?.kind === 'split' ? ['left', 'right'] : ['left'];
  const rows = sides.flatMap((side) =>
    frames[side].map((frame) => [
      side,
      ...COLUMNS.map(([, read]) => cell(read(frame))),
      ...passes.map((pass) => cell(frame.timing.passMs[pass] ?? null)),
    ]),
  );
  return [header, ...rows].map((row) => `${row.join(',')}\n`).join('');
}

function passColumn(pass: TimedPass): string {
  return `pass_${pass.replaceAll('-', '_')}_ms`;
}

function cell(value: string | number | null): string {
  return value === null || Number.isNaN(value) ? '' : String(value);
}
