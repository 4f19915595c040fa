/** The shown part of a measurement, CSS pixels from the canvas's top left. */
export interface MeasureMarks {
  /** Positions of the points in the order of picking; null if a point is out of sight. */
  readonly points: readonly (readonly [x: number, y: number] | null)[];
  /** Text at the line's middle; null before there is a distance. */
  readonly text: string | null;
  /** Position of the keyboard's cross; null unless the keyboard is in use. */
  readonly cross: readonly [x: number, y: number] | null;
}

const SVG = 'http://www.w3.org/2000/svg';

// Two strokes, dark under light, are legible over any splats.
const STROKES = [
  { stroke: '#000000b3', 'stroke-width': '4' },
  { stroke: '#ffffff', 'stroke-width': '2' },
] as const;
const POINT_RADIUS_PX = 5;
const CROSS_PX = 12;
/** A shorter line has its text above it, where it hides neither point. */
const LONG_LINE_PX = 110;
const TEXT_ABOVE_PX = 24;
const TEXT_STYLE =
  'position:absolute;left:0;top:0;padding:2px 8px;border-radius:6px;width:max-content;' +
  'font:600 13px/1.4 system-ui,sans-serif;font-variant-numeric:tabular-nums;' +
  'color-scheme:light dark;color:light-dark(#1a1a1a,#f2f2f2);background:light-dark(#ffffffe6,#161616e6)';
/** Visually hidden text for screen readers. */
const STATUS_STYLE =
  'position:absolute;width:1px;height:1px;overflow:hidden;clip-path:inset(50%);white-space:nowrap';

/** The overlay of `<SplatMeasure>`: a line between two points, its length, the keyboard's cross. */
export class MeasureOverlay {
  readonly element: HTMLElement;
  readonly #lines: SVGElement[];
  readonly #crosses: SVGElement[];
  readonly #points: SVGElement[][];
  readonly #text: HTMLElement;
  readonly #status: HTMLElement;

  constructor(document: Document) {
    this.element = document.createElement('div');
    this.element.style.cssText =
      'position:absolute;inset:0;overflow:hidden;isolation:isolate;pointer-events:none';
    const svg = document.createElementNS(SVG, 'svg');
    svg.style.cssText = 'position:absolute;inset:0;width:100%;height:100%';
    svg.setAttribute('aria-hidden', 'true');
    const draw = (name: string, attributes: Record<string, string> = {}) =>
      STROKES.map((strokes) => {
        const shape = document.createElementNS(SVG, name);
        for (const [key, value] of Object.entries({ fill: 'none', ...strokes, ...attributes }))
          shape.setAttribute(key, value);
        svg.append(shape);
        return shape;
      });
    this.#lines = draw('line', { 'stroke-linecap': 'round' });
    this.#points = [0, 1].map(() => draw('circle', { r: String(POINT_RADIUS_PX) }));
    this.#crosses = draw('path', { d: `M${-CROSS_PX} 0H${CROSS_PX}M0 ${-CROSS_PX}V${CROSS_PX}` });
    this.#text = document.createElement('div');
    this.#text.style.cssText = TEXT_STYLE;
    this.#status = document.createElement('div');
    this.#status.style.cssText = STATUS_STYLE;
    this.#status.setAttribute('role', 'status');
    this.element.append(svg, this.#text, this.#status);
    this.show({ points: [], text: null, cross: null });
  }

  show({ points, text, cross }: MeasureMarks): void {
    const [from = null, to = null] = points;
    for (const [i, shapes] of this.#points.entries()) placed(shapes, points[i] ?? null);
    placed(this.#crosses, cross);
    const isLine = from !== null && to !== null;
    for (const line of this.#lines) {
      line.style.display = isLine ? '' : 'none';
      if (!isLine) continue;
      for (const [key, value] of Object.entries({ x1: from[0], y1: from[1], x2: to[0], y2: to[1] }))
        line.setAttribute(key, value.toFixed(2));
    }
    const isText = isLine && text !== null;
    this.#text.style.display = isText ? '' : 'none';
    if (!isText) return;
    if (this.#text.textContent !== text) this.#text.textContent = text;
    const x = (from[0] + to[0]) / 2;
    const isLong = Math.hypot(from[0] - to[0], from[1] - to[1]) >= LONG_LINE_PX;
    const y = isLong ? (from[1] + to[1]) / 2 : Math.min(from[1], to[1]) - TEXT_ABOVE_PX;
    this.#text.style.transform = `translate3d(${x.toFixed(2)}px,${y.toFixed(2)}px,0) translate(-50%,-50%)`;
  }

  /** Announces a text to screen readers. */
  say(text: string): void {
    this.#status.textContent = text;
  }
}

function placed(shapes: readonly SVGElement[], place: readonly [number, number] | null): void {
  for (const shape of shapes) {
    shape.style.display = place ? '' : 'none';
    if (place) shape.setAttribute('transform', `translate(${place[0].toFixed(2)} ${place[1].toFixed(2)})`);
  }
}
