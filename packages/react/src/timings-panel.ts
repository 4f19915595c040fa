import { type FrameStatistics, isPlausible } from '@websplatter/core';

/** The corner of the canvas that a panel is in. */
export type PanelCorner = 'top-left' | 'top-right' | 'bottom-left' | 'bottom-right';

/** Figures that change sixty times a second cannot be read. */
const UPDATE_INTERVAL_MS = 250;

// Set by the style object, as content security policies allow. `light-dark` follows the system.
const PANEL_STYLE =
  'position:absolute;z-index:1;margin:8px;padding:6px 10px;border-radius:6px;width:max-content;pointer-events:none;' +
  'font:12px/1.4 system-ui,sans-serif;font-variant-numeric:tabular-nums;text-align:left;' +
  'color-scheme:light dark;color:light-dark(#1a1a1a,#f2f2f2);background:light-dark(#ffffffd9,#161616d9)';
const LIST_STYLE = 'margin:0;display:grid;grid-template-columns:auto auto;gap:1px 12px';
/** As wide as `1,234,567`, so that longer figures do not change the layout. */
const VALUE_STYLE = 'margin:0;min-width:9ch;text-align:right';

const ROWS = [
  'Pre-process',
  'Sort',
  'Rasterise',
  'Frame',
  'Wall clock',
  'Rasteriser',
  'Frames per second',
  'Splats visible',
  'Splats loaded',
  'GPU memory',
] as const;
type Row = (typeof ROWS)[number];

/** Rows over a small canvas. */
const ROWS_IF_SMALL: readonly Row[] = ['Wall clock', 'Frames per second', 'GPU memory'];
/** Area of a small canvas, CSS px²: the whole panel, 230 × 220 px, would cover more than a quarter. */
const SMALL_AREA_PX2 = 200_000;
const SMALL_HEIGHT_PX = 260;

/** Work of the engine so far, and its memory now. */
export interface EngineState {
  readonly framesDrawn: number;
  readonly memoryBytes: number;
  /** `performance.now()` when the state was read. */
  readonly nowMs: number;
}

/** Updates farther apart than this give no frame rate: no frames were drawn in between. */
const MAX_RATE_INTERVAL_MS = 1000;

export interface TimingsPanel {
  readonly element: HTMLElement;
  /** Shows these figures now, or a quarter of a second after the previous ones. */
  show(statistics: FrameStatistics): void;
  /** Removes the element. */
  remove(): void;
}

/**
 * Creates the overlay of `<SplatStats>`. Updates write to its text nodes and change nothing else.
 *
 * @param readEngine called for each update.
 */
export function createTimingsPanel(
  document: Document,
  corner: PanelCorner,
  readEngine: () => EngineState,
): TimingsPanel {
  const element = document.createElement('div');
  element.style.cssText = PANEL_STYLE;
  for (const side of corner.split('-')) element.style.setProperty(side, '0');
  element.setAttribute('role', 'group');
  element.setAttribute('aria-label', 'Cost of the splats');
  const list = document.createElement('dl');
  list.style.cssText = LIST_STYLE;
  const values = new Map<Row, Text>();
  /** Elements that are hidden over a small canvas. */
  const parts: HTMLElement[] = [];
  for (const row of ROWS) {
    const [term, value] = [document.createElement('dt'), document.createElement('dd')];
    value.style.cssText = VALUE_STYLE;
    const text = document.createTextNode('–');
    values.set(row, text);
    term.append(row);
    value.append(text);
    list.append(term, value);
    if (!ROWS_IF_SMALL.includes(row)) parts.push(term, value);
  }
  const note = document.createTextNode('Not measured yet');
  const noteElement = document.createElement('div');
  noteElement.append(note);
  parts.push(noteElement);
  element.append(list, noteElement);

  let latest: FrameStatistics | null = null;
  let before: EngineState | null = null;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const write = () => {
    timer = undefined;
    if (!latest) return;
    const engine = readEngine();
    const words = wordsFor(latest, engine, before);
    latest = null;
    before = engine;
    for (const row of ROWS) values.get(row)!.data = words.values[row];
    note.data = words.note;
    const { clientWidth = 0, clientHeight = 0 } = element.parentElement ?? {};
    const isSmall = clientWidth * clientHeight < SMALL_AREA_PX2 || clientHeight < SMALL_HEIGHT_PX;
    for (const part of parts) part.hidden = isSmall;
    timer = setTimeout(write, UPDATE_INTERVAL_MS);
  };
  return {
    element,
    show: (statistics) => {
      latest = statistics;
      if (timer === undefined) write();
    },
    remove: () => {
      clearTimeout(timer);
      element.remove();
    },
  };
}

/**
 * Returns the texts of the panel.
 *
 * @param before `engine` at the last update; null at the first.
 */
export function wordsFor(
  { timing, rasterizer, visibleSplats, loadedSplats }: FrameStatistics,
  engine: EngineState,
  before: EngineState | null,
): {
  readonly values: Readonly<Record<Row, string>>;
  readonly note: string;
} {
  const isMeasuredByGpu = timing.source === 'gpu-timestamps';
  const values = {
    'Pre-process': milliseconds(timing.preprocessMs),
    Sort: milliseconds(timing.sortMs),
    Rasterise: milliseconds(timing.rasterizeMs),
    Frame: milliseconds(isMeasuredByGpu ? timing.totalMs : Number.NaN),
    'Wall clock': milliseconds(timing.wallClockMs),
    Rasteriser: rasterizer,
    'Frames per second': frameRate(engine, before),
    'Splats visible': visibleSplats.toLocaleString('en'),
    'Splats loaded': loadedSplats.toLocaleString('en'),
    'GPU memory': `${(engine.memoryBytes / 1e6).toFixed(1)} MB`,
  };
  if (!isMeasuredByGpu) return { values, note: 'No GPU timestamps here' };
  return { values, note: isPlausible(timing) ? 'GPU timestamps' : 'GPU timestamps, doubtful' };
}

function frameRate(engine: EngineState, before: EngineState | null): string {
  const elapsedMs = before ? engine.nowMs - before.nowMs : 0;
  if (!before || elapsedMs <= 0 || elapsedMs > MAX_RATE_INTERVAL_MS) return '–';
  return ((1000 * (engine.framesDrawn - before.framesDrawn)) / elapsedMs).toFixed(0);
}

function milliseconds(value: number): string {
  return Number.isNaN(value) ? '–' : `${value.toFixed(2)} ms`;
}
