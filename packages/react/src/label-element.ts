/** How long a label takes to fade, ms. */
const FADE_MS = 160;
/** z-index of the nearest label; farther ones have lower values. */
const TOP_Z_INDEX = 1000;

/** Events that stop at the label: the scene would receive them with the label's coordinates. */
const OWN_EVENTS = [
  'click',
  'contextmenu',
  'dblclick',
  'pointercancel',
  'pointerdown',
  'pointermove',
  'pointerup',
] as const;

interface LabelLayer {
  readonly element: HTMLElement;
  labels: number;
}

/** Element of the labels by canvas. Their z-index is local to it: labels never cover the app's elements. */
const layers = new WeakMap<HTMLElement, LabelLayer>();

function layerOver(canvas: HTMLElement): LabelLayer {
  let layer = layers.get(canvas);
  if (!layer) {
    layer = { element: canvas.ownerDocument.createElement('div'), labels: 0 };
    layer.element.style.cssText =
      'position:absolute;inset:0;overflow:hidden;isolation:isolate;pointer-events:none';
    layers.set(canvas, layer);
  }
  if (layer.labels === 0) canvas.parentElement?.append(layer.element);
  return layer;
}

/** The HTML element of a label over a canvas. */
export class LabelElement {
  /** Parent of the label's content. */
  readonly content: HTMLElement;
  readonly #outer: HTMLElement;
  readonly #layer: LabelLayer;
  #isInSight = false;
  #isCovered = false;

  /** @param canvas the label is added to its parent. */
  constructor(canvas: HTMLElement) {
    const { ownerDocument } = canvas;
    this.#layer = layerOver(canvas);
    this.#layer.labels++;
    this.#outer = ownerDocument.createElement('div');
    this.content = ownerDocument.createElement('div');
    const { style } = this.#outer;
    style.cssText =
      'position:absolute;left:0;top:0;width:max-content;pointer-events:auto;will-change:transform,opacity';
    // jsdom has no `matchMedia`.
    const isStill = ownerDocument.defaultView?.matchMedia?.('(prefers-reduced-motion: reduce)').matches;
    // `visibility: hidden` also hides the label from keyboard, pointer and screen readers.
    style.transition = isStill ? 'none' : `opacity ${FADE_MS}ms, visibility ${FADE_MS}ms`;
    for (const type of OWN_EVENTS) this.#outer.addEventListener(type, (event) => event.stopPropagation());
    // An element with the focus stays visible.
    for (const type of ['focusin', 'focusout']) this.#outer.addEventListener(type, () => this.#show());
    this.#outer.append(this.content);
    this.#layer.element.append(this.#outer);
    this.#show();
  }

  /**
   * Moves the label's middle to a position on the canvas.
   *
   * @param x, y CSS pixels from the top left.
   * @param rank place among all labels, 0 for the nearest.
   */
  place(x: number, y: number, scale: number, rank: number): void {
    const { style } = this.#outer;
    style.transform = `translate3d(${x.toFixed(2)}px,${y.toFixed(2)}px,0) translate(-50%,-50%) scale(${scale.toFixed(4)})`;
    style.zIndex = String(Math.max(1, TOP_Z_INDEX - rank));
    this.#isInSight = true;
    this.#show();
  }

  /** Hides the label: its point is outside of the image. */
  leaveSight(): void {
    this.#isInSight = false;
    this.#show();
  }

  /** @returns whether the state has changed. */
  cover(isCovered: boolean): boolean {
    if (this.#isCovered === isCovered) return false;
    this.#isCovered = isCovered;
    this.#show();
    return true;
  }

  remove(): void {
    this.#outer.remove();
    if (--this.#layer.labels === 0) this.#layer.element.remove();
  }

  #show(): void {
    const { style } = this.#outer;
    const isFocused = this.#outer.contains(this.#outer.ownerDocument.activeElement);
    const isShown = this.#isInSight && (!this.#isCovered || isFocused);
    style.opacity = isShown ? '1' : '0';
    style.visibility = isShown ? 'visible' : 'hidden';
  }
}
