import { DestroyedError } from '@websplatter/core';
import type { Vector3 } from 'three';
import { MeasureOverlay } from './measure-overlay.ts';

/** Unit and format of lengths. */
export interface MeasureUnit {
  /** Symbol of the unit, such as `m`; default none. */
  readonly name?: string;
  /** Number of these units in one world unit; default 1. */
  readonly perWorldUnit?: number;
  /** Decimal places, 0…20; default 2. */
  readonly digits?: number;
}

/** A distance between two points that were picked. */
export interface Measurement {
  /** World space. */
  readonly from: Vector3;
  /** World space. */
  readonly to: Vector3;
  /** World units. */
  readonly distance: number;
  /** Formatted distance in the chosen unit. */
  readonly text: string;
}

/** State of the tool's Canvas. */
export interface MeasureHost {
  readonly canvas: HTMLElement;
  /** Returns the world point at a position, CSS pixels from the canvas's top left; null if none. */
  pick(x: number, y: number): Promise<Vector3 | null>;
  /** Returns the position of a world point on the canvas, CSS pixels; null if out of sight. */
  project(point: Vector3): readonly [x: number, y: number] | null;
  readonly unit: () => MeasureUnit;
  readonly onMeasure: (measurement: Measurement) => void;
}

/** A pointer that moves farther than this between down and up drags; CSS pixels. */
const MAX_CLICK_PX = 4;
/** Steps of the keyboard's cross, CSS pixels. */
const STEP_PX = 10;
const SMALL_STEP_PX = 1;
const DIRECTIONS: Readonly<Record<string, readonly [x: number, y: number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};
const LABEL =
  'Measure a distance. Arrow keys move a cross, with Shift by single pixels. Enter sets a point, Backspace removes the last point, Escape starts over.';

/** Measures distances between points that are clicked on, or chosen by keyboard. */
export class MeasureTool {
  readonly #host: MeasureHost;
  readonly #overlay: MeasureOverlay;
  readonly #abort = new AbortController();
  #points: Vector3[] = [];
  /** Position where the pointer went down; null after it has dragged. */
  #pressed: readonly [number, number] | null = null;
  #cross: [number, number] | null = null;
  #hasFocus = false;
  /** Serial number of the newest pick: results of older picks are ignored. */
  #newest = 0;

  constructor(host: MeasureHost) {
    this.#host = host;
    const { canvas } = host;
    this.#overlay = new MeasureOverlay(canvas.ownerDocument);
    const { element } = this.#overlay;
    element.tabIndex = 0;
    element.setAttribute('role', 'application');
    element.setAttribute('aria-label', LABEL);
    element.style.outlineOffset = '-2px';
    canvas.parentElement?.append(element);

    const { signal } = this.#abort;
    canvas.addEventListener('pointerdown', (event) => this.#press(event), { signal });
    // Controls may have captured the pointer for another element.
    canvas.ownerDocument.addEventListener('pointerup', (event) => this.#release(event), { signal });
    element.addEventListener('keydown', (event) => this.#key(event), { signal });
    element.addEventListener('focus', () => this.#focus(true), { signal });
    element.addEventListener('blur', () => this.#focus(false), { signal });
  }

  /** Moves the marks to the points' positions in the last frame. */
  draw(): void {
    const { project, unit } = this.#host;
    this.#overlay.show({
      points: this.#points.map(project),
      text: this.#points.length === 2 ? textOf(this.#distance(), unit()) : null,
      cross: this.#hasFocus ? this.#cross : null,
    });
  }

  clear(): void {
    this.#newest++;
    this.#points = [];
    this.draw();
  }

  remove(): void {
    this.#newest++;
    this.#abort.abort();
    this.#overlay.element.remove();
  }

  #press({ isPrimary, button, clientX, clientY }: PointerEvent): void {
    this.#pressed = isPrimary && button === 0 ? [clientX, clientY] : null;
  }

  #release({ isPrimary, clientX, clientY }: PointerEvent): void {
    const pressed = this.#pressed;
    if (!isPrimary || !pressed) return;
    this.#pressed = null;
    if (Math.hypot(clientX - pressed[0], clientY - pressed[1]) > MAX_CLICK_PX) return;
    const { left, top } = this.#host.canvas.getBoundingClientRect();
    void this.#set(clientX - left, clientY - top);
  }

  #focus(hasFocus: boolean): void {
    const { clientWidth, clientHeight } = this.#overlay.element;
    this.#hasFocus = hasFocus;
    this.#cross ??= [clientWidth / 2, clientHeight / 2];
    this.draw();
  }

  #key(event: KeyboardEvent): void {
    const { key, shiftKey, ctrlKey, metaKey, altKey } = event;
    if (ctrlKey || metaKey || altKey || !this.#cross) return;
    const direction = DIRECTIONS[key];
    if (direction) {
      const step = shiftKey ? SMALL_STEP_PX : STEP_PX;
      const { clientWidth, clientHeight } = this.#overlay.element;
      const [x, y] = this.#cross;
      this.#cross = [
        within(x + step * direction[0], clientWidth),
        within(y + step * direction[1], clientHeight),
      ];
      this.draw();
    } else if (key === 'Enter' || key === ' ') void this.#set(...this.#cross);
    else if (key === 'Escape') this.clear();
    else if (key === 'Backspace') {
      this.#newest++;
      this.#points = this.#points.slice(0, -1);
      this.draw();
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }

  async #set(x: number, y: number): Promise<void> {
    const number = ++this.#newest;
    let point: Vector3 | null;
    try {
      point = await this.#host.pick(x, y);
    } catch (error) {
      // The renderer reports a lost device.
      if (!(error instanceof DestroyedError)) console.warn(error);
      return;
    }
    if (number !== this.#newest) return;
    if (!point) {
      this.#overlay.say('There is nothing to measure here.');
      return;
    }
    this.#points = this.#points.length < 2 ? [...this.#points, point] : [point];
    this.draw();
    if (this.#points.length < 2) {
      this.#overlay.say('First point set.');
      return;
    }
    const [from, to] = this.#points;
    const text = textOf(this.#distance(), this.#host.unit());
    this.#overlay.say(`Distance: ${text}`);
    this.#host.onMeasure({ from: from.clone(), to: to.clone(), distance: this.#distance(), text });
  }

  #distance(): number {
    return this.#points[0].distanceTo(this.#points[1]);
  }
}

function within(value: number, size: number): number {
  return Math.min(Math.max(value, 0), Math.max(0, size - 1));
}

/** Formats a distance in world units. */
export function textOf(distance: number, { name = '', perWorldUnit = 1, digits = 2 }: MeasureUnit): string {
  return `${(distance * perWorldUnit).toFixed(digits)} ${name}`.trim();
}
