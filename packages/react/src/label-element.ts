/** How long a label takes to fade, ms. */
const FADE_MS = 160;
/** Of the nearest label, among the labels of a canvas. */
const TOP_Z_INDEX = 1000;

/** Events of a label's content. Below it they would hit the scene, at coordinates of the label. */
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

/** By canvas: the element of its labels, which overlap one another, but no element of the app. */
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

/** The HTML of a label over a canvas, and how it is shown. */
export class LabelElement {
  /** Where the content goes. */
  readonly content: HTMLElement;
  readonly #outer: HTMLElement;
  readonly #layer: LabelLayer;
  #isInSight = false;
  #isCovered = false;

  /** @param canvas whose parent gets the label. */
  constructor(canvas: HTMLElement) {
    const { ownerDocument } = canvas;
    this.#layer = layerOver(canvas);
    this.#layer.labels++;
    this.#outer = ownerDocument.createElement('div');
    this.content = ownerDocument.createElement('div');
    const { style } = this.#outer;
    style.cssText =
      'position:absolute;left:0;top:0;width:max-content;pointer-events:auto;will-change:transform,opacity';
    const isStill = ownerDocument.defaultView?.matchMedia('(prefers-reduced-motion: reduce)').matches;
    // Keyboard, pointer and screen readers pass invisible elements.
    style.transition = isStill ? 'none' : `opacity ${FADE_MS}ms, visibility ${FADE_MS}ms`;
    for (const type of OWN_EVENTS) this.#outer.addEventListener(type, (event) => event.stopPropagation());
    // An element with the focus must not vanish under the reader.
    for (const type of ['focusin', 'focusout']) this.#outer.addEventListener(type, () => this.#show());
    this.#outer.append(this.content);
    this.#layer.element.append(this.#outer);
    this.#show();
  }

  /**
   * Puts the label's middle at a place of the canvas.
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

  /** The point is not in the image. */
  leaveSight(): void {
    this.#isInSight = false;
    this.#show();
  }

  /** @returns whether this is news. */
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
