import type { StageTimings } from '@websplatter/core';
import { formatCount, formatMs } from '@websplatter/kit/format';
import { observeTheme } from '@websplatter/kit/theme';
import { HISTORY_FRAMES } from './frame-recorder.ts';
import {
  CHART_LAYERS,
  type ChartLayer,
  FRAME_BUDGET_MS,
  type HistoryLayout,
  historyLayout,
} from './history-layout.ts';

const FONT_PX = 10;
const DASH_PX = 3;

/** Colours as the canvas takes them, from the panel's own swatches. */
interface Palette {
  readonly layers: Readonly<Record<ChartLayer, string>>;
  readonly text: string;
  readonly halo: string;
}

/** Bars of the last frames' times on a canvas; lines at median, 99th percentile and budget. */
export class HistoryChart {
  readonly #canvas: HTMLCanvasElement;
  readonly #stop: () => void;
  #palette: Palette | null = null;
  #frames: readonly StageTimings[] = [];

  /** @param canvas lies in the panel, which has a swatch `.stage-NAME` of each layer. */
  constructor(canvas: HTMLCanvasElement) {
    this.#canvas = canvas;
    const resize = new ResizeObserver(([{ contentRect }]) => {
      canvas.width = Math.round(contentRect.width * devicePixelRatio);
      canvas.height = Math.round(contentRect.height * devicePixelRatio);
      this.#paint();
    });
    resize.observe(canvas);
    const recolor = () => {
      this.#palette = null;
      this.#paint();
    };
    const forced = matchMedia('(forced-colors: active)');
    forced.addEventListener('change', recolor);
    const stopTheme = observeTheme(recolor);
    this.#stop = () => {
      resize.disconnect();
      stopTheme();
      forced.removeEventListener('change', recolor);
    };
  }

  /** @param frames oldest first. */
  show(frames: readonly StageTimings[]): void {
    this.#frames = frames;
    this.#paint();
  }

  destroy(): void {
    this.#stop();
  }

  #paint(): void {
    const { width: widthPx, height: heightPx } = this.#canvas;
    const context = this.#canvas.getContext('2d');
    if (!context || widthPx === 0 || heightPx === 0) return;
    const layout = historyLayout(this.#frames, { widthPx, heightPx, capacity: HISTORY_FRAMES });
    this.#palette ??= paletteOf(this.#canvas);
    context.clearRect(0, 0, widthPx, heightPx);
    paintBars(context, layout, this.#palette);
    paintLines(context, layout, this.#palette);
  }
}

function paletteOf(canvas: HTMLCanvasElement): Palette {
  const panel = canvas.closest('.hud') ?? canvas;
  const colorOf = (layer: ChartLayer) => {
    const swatch = panel.querySelector(`.stage-${layer}`);
    return swatch ? getComputedStyle(swatch).backgroundColor : '';
  };
  const { color, backgroundColor } = getComputedStyle(panel);
  const layers = Object.fromEntries(CHART_LAYERS.map((layer) => [layer, colorOf(layer)]));
  return { layers: layers as Palette['layers'], text: color, halo: backgroundColor };
}

function paintBars(
  context: CanvasRenderingContext2D,
  { rects, cut, barWidthPx }: HistoryLayout,
  { layers, text }: Palette,
): void {
  // One path for each layer: hundreds of calls to fill would take longer.
  for (const layer of CHART_LAYERS) {
    const list = rects[layer];
    context.beginPath();
    for (let i = 0; i < list.length; i += 4) context.rect(list[i], list[i + 1], list[i + 2], list[i + 3]);
    context.fillStyle = layers[layer];
    context.fill();
  }
  context.fillStyle = text;
  for (const x of cut) context.fillRect(x, 0, Math.max(2, barWidthPx), 2 * devicePixelRatio);
}

function paintLines(
  context: CanvasRenderingContext2D,
  { topMs, medianPx, p99Px, budgetPx }: HistoryLayout,
  { text, halo }: Palette,
): void {
  const { width, height } = context.canvas;
  const scale = devicePixelRatio;
  const line = (y: number | null, dashPx: readonly number[]) => {
    if (y === null) return;
    context.setLineDash(dashPx.map((length) => length * scale));
    context.beginPath();
    context.moveTo(0, y - scale / 2);
    context.lineTo(width, y - scale / 2);
    context.stroke();
  };
  context.strokeStyle = text;
  context.lineWidth = scale;
  line(medianPx, []);
  line(p99Px, [DASH_PX, DASH_PX]);
  line(budgetPx, [1, DASH_PX]);
  context.setLineDash([]);
  context.font = `${FONT_PX * scale}px system-ui, sans-serif`;
  context.textBaseline = 'top';
  // Text must be legible over bars, too.
  const write = (words: string, y: number) => {
    context.strokeStyle = halo;
    context.lineWidth = 3 * scale;
    context.lineJoin = 'round';
    context.strokeText(words, 2 * scale, y);
    context.fillStyle = text;
    context.fillText(words, 2 * scale, y);
  };
  const budget = `${formatMs(FRAME_BUDGET_MS)} ms`;
  const rowPx = (FONT_PX + 2) * scale;
  write(budgetPx === null ? `${formatTop(topMs)} · ${budget} is above` : formatTop(topMs), scale);
  // Below its line where there is room.
  if (budgetPx !== null)
    write(budget, budgetPx + rowPx > height ? budgetPx - rowPx : Math.max(budgetPx + scale, rowPx));
}

function formatTop(topMs: number): string {
  return `${formatCount(topMs)} ms`;
}
