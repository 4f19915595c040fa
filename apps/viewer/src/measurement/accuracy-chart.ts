import type { AccuracyPoint } from '@websplatter/core/measure';
import uPlot from 'uplot';
import { type ChartLayout, chartLayout, type PlacedPoint } from './chart-layout.ts';
import { placeLabels } from './place-labels.ts';

const HEIGHT_PX = 230;
const LABEL_FONT_PX = 11;
const LABEL_HEIGHT_PX = 14;

export interface ChartContents {
  readonly points: readonly AccuracyPoint[];
  /** The point whose settings are drawn now; −1 for none. */
  readonly current: number;
}

export interface ChartEvents {
  /** A point was clicked, or chosen by Enter. */
  readonly onPick: (index: number) => void;
  /** A point is under the pointer or has the focus; null when it no longer is. */
  readonly onLook: (index: number | null) => void;
}

/** Error against time: uPlot draws axes and the front; points are buttons over it, for pointers and keys alike. */
export class AccuracyChart {
  readonly #root: HTMLElement;
  readonly #events: ChartEvents;
  readonly #plot: uPlot;
  readonly #stop: () => void;
  #contents: ChartContents = { points: [], current: -1 };
  #layout: ChartLayout = chartLayout([]);

  constructor(root: HTMLElement, events: ChartEvents) {
    this.#root = root;
    this.#events = events;
    this.#plot = new uPlot(this.#options(), [[], []], root);
    const resize = new ResizeObserver(() => this.#resize());
    resize.observe(root);
    const scheme = matchMedia('(prefers-color-scheme: dark)');
    const recolor = () => this.#plot.redraw();
    scheme.addEventListener('change', recolor);
    this.#stop = () => {
      resize.disconnect();
      scheme.removeEventListener('change', recolor);
    };
  }

  show(contents: ChartContents): void {
    const isSameTable = contents.points === this.#contents.points;
    this.#contents = contents;
    if (isSameTable) {
      this.#mark();
      return;
    }
    this.#layout = chartLayout(contents.points);
    const { frontLine } = this.#layout;
    this.#plot.setData([frontLine.map(({ xMs }) => xMs), frontLine.map(({ yDb }) => yDb)]);
  }

  destroy(): void {
    this.#stop();
    this.#plot.destroy();
  }

  #options(): uPlot.Options {
    const style = () => getComputedStyle(this.#root);
    const axis: uPlot.Axis = {
      stroke: () => style().color,
      grid: { stroke: () => style().borderTopColor, width: 1 },
      ticks: { show: false },
      font: '11px system-ui, sans-serif',
      labelFont: '11px system-ui, sans-serif',
      labelSize: 16,
      labelGap: 0,
      gap: 4,
    };
    return {
      width: Math.max(1, this.#root.clientWidth),
      height: HEIGHT_PX,
      padding: [8, 8, 0, 0],
      legend: { show: false },
      cursor: { show: false },
      scales: {
        x: { time: false, range: () => [...this.#layout.xRange] },
        y: { range: () => [...this.#layout.yRange] },
      },
      axes: [
        { ...axis, label: 'milliseconds a frame', size: 24, space: 44 },
        {
          ...axis,
          label: 'PSNR in dB, higher is better',
          size: 34,
          space: 30,
          filter: (_, splits) => this.#belowBand(splits),
          grid: { ...axis.grid, filter: (_, splits) => this.#belowBand(splits) },
        },
      ],
      series: [
        {},
        {
          stroke: () => style().outlineColor,
          width: 1.5,
          points: { show: false },
          paths: uPlot.paths.stepped?.({ align: 1 }),
        },
      ],
      hooks: { drawClear: [() => this.#drawBand()], draw: [() => this.#placePoints()] },
    };
  }

  /** There are no decibels in the band of points that equal the reference. */
  #belowBand(splits: readonly number[]): (number | null)[] {
    const { equalFromDb } = this.#layout;
    return splits.map((value) => (equalFromDb === null || value < equalFromDb ? value : null));
  }

  #drawBand(): void {
    const { equalFromDb } = this.#layout;
    if (equalFromDb === null) return;
    const { ctx, bbox } = this.#plot;
    const { color, borderTopColor } = getComputedStyle(this.#root);
    const bottom = this.#plot.valToPos(equalFromDb, 'y', true);
    ctx.save();
    ctx.fillStyle = borderTopColor;
    ctx.fillRect(bbox.left, bbox.top, bbox.width, bottom - bbox.top);
    ctx.fillStyle = color;
    ctx.font = `${LABEL_FONT_PX * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textAlign = 'right';
    ctx.textBaseline = 'middle';
    ctx.fillText('equal', bbox.left - 4 * devicePixelRatio, (bbox.top + bottom) / 2);
    ctx.restore();
  }

  #resize(): void {
    const width = this.#root.clientWidth;
    if (width > 0 && width !== this.#plot.width) this.#plot.setSize({ width, height: HEIGHT_PX });
  }

  #placePoints(): void {
    const { over } = this.#plot;
    const { placed } = this.#layout;
    const place = ({ xMs, yDb }: PlacedPoint) => ({
      x: this.#plot.valToPos(xMs, 'x'),
      y: this.#plot.valToPos(yDb, 'y'),
    });
    const focused = over.querySelector(':focus')?.getAttribute('data-index');
    const buttons = placed.map((point) => this.#button(point, place(point)));
    const labelled = [...placed].sort((a, b) => b.importance - a.importance);
    const boxes = placeLabels(
      labelled.map((point) => ({
        ...place(point),
        width: this.#textWidth(point.label),
        height: LABEL_HEIGHT_PX,
      })),
      { left: 2, top: 0, width: over.clientWidth - 4, height: over.clientHeight },
    );
    const labels = boxes.flatMap((box, i) => (box ? [labelAt(labelled[i].label, box.left, box.top)] : []));
    over.replaceChildren(...labels, ...buttons);
    this.#mark();
    if (focused) over.querySelector<HTMLElement>(`[data-index="${focused}"]`)?.focus();
  }

  #button(point: PlacedPoint, { x, y }: { x: number; y: number }): HTMLButtonElement {
    const { index, name, label, lowMs, highMs, isOnFront, words } = point;
    const button = document.createElement('button');
    button.type = 'button';
    button.className = isOnFront ? 'chart-point on-front' : 'chart-point';
    button.style.left = `${x}px`;
    button.style.top = `${y}px`;
    button.dataset.index = String(index);
    button.dataset.testid = 'accuracy-point';
    button.dataset.name = name;
    button.setAttribute('aria-label', `${label}: ${words}`);
    const interval = document.createElement('i');
    const left = this.#plot.valToPos(lowMs, 'x');
    interval.style.left = `calc(50% + ${left - x}px)`;
    interval.style.width = `${this.#plot.valToPos(highMs, 'x') - left}px`;
    button.append(interval);
    const { onPick, onLook } = this.#events;
    button.addEventListener('click', () => onPick(index));
    for (const type of ['pointerenter', 'focus']) button.addEventListener(type, () => onLook(index));
    for (const type of ['pointerleave', 'blur']) button.addEventListener(type, () => onLook(null));
    button.addEventListener('keydown', (event) => this.#moveFocus(event, index));
    return button;
  }

  /** Arrow keys go from point to point, in order of time; the Tab key stops at one of them only. */
  #moveFocus(event: KeyboardEvent, index: number): void {
    const by = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    // Arrows elsewhere turn the scene.
    event.stopPropagation();
    const order = this.#layout.placed.map((point) => point.index);
    const next = order[(order.indexOf(index) + by + order.length) % order.length];
    this.#plot.over.querySelector<HTMLElement>(`[data-index="${next}"]`)?.focus();
  }

  #mark(): void {
    const { current } = this.#contents;
    const buttons = [...this.#plot.over.querySelectorAll<HTMLElement>('.chart-point')];
    const isShown = buttons.some(({ dataset }) => dataset.index === String(current));
    for (const [at, button] of buttons.entries()) {
      const isCurrent = button.dataset.index === String(current);
      button.setAttribute('aria-pressed', String(isCurrent));
      button.tabIndex = isCurrent || (!isShown && at === 0) ? 0 : -1;
    }
  }

  #textWidth(text: string): number {
    const { ctx } = this.#plot;
    ctx.save();
    ctx.font = `${LABEL_FONT_PX}px system-ui, sans-serif`;
    const { width } = ctx.measureText(text);
    ctx.restore();
    return width + 2;
  }
}

function labelAt(text: string, left: number, top: number): HTMLElement {
  const label = document.createElement('span');
  label.className = 'chart-label';
  label.textContent = text;
  label.style.left = `${left}px`;
  label.style.top = `${top}px`;
  // The point itself says it.
  label.setAttribute('aria-hidden', 'true');
  return label;
}
