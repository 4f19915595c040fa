import { DestroyedError, type PointToCover } from '@websplatter/core';
import { coverageOf } from '@websplatter/three';
import { type Camera, type Object3D, Vector3 } from 'three';
import { type CanvasPlace, placeOnCanvas } from './place-on-canvas.ts';

/** Shortest time between two coverage queries, ms: labels fade for longer. */
const CHECK_INTERVAL_MS = 100;
/** Most labels of one query: it compares each visible splat with each label, and other GPU work waits. */
const LABELS_PER_QUESTION = 256;

/** State of a Canvas for the board. */
export interface BoardView {
  readonly renderer: object;
  readonly scene: Object3D;
  readonly camera: Camera;
  /** CSS pixels. */
  readonly size: { readonly width: number; readonly height: number };
}

/** A label at a point in world space. */
export interface BoardLabel {
  /** Object whose origin is the label's point. */
  readonly object: Object3D;
  /** Whether splats and meshes hide it. */
  readonly canBeCovered: boolean;
  /** Least joint opacity of the splats in front, 0…1, that hides the label. */
  readonly hideAt: number;
  /** See `PointToCover`, world units; undefined: TOLERANCE of its distance. */
  readonly tolerance: number | undefined;
  /**
   * Moves the label to its point's position on the canvas.
   *
   * @param x, y CSS pixels from the canvas's top left.
   * @param depthView distance along the line of sight, world units.
   * @param rank place among all labels by distance, 0 for the nearest.
   */
  place(x: number, y: number, depthView: number, rank: number): void;
  /** Hides the label: its point is outside of the image. */
  leaveSight(): void;
  /** Hides the label if splats or meshes cover its point; else shows it. */
  cover(isCovered: boolean): void;
}

/** Default tolerance in parts of a label's distance: about the difference between rays and picks. */
const TOLERANCE = 0.02;

interface SeenLabel {
  readonly label: BoardLabel;
  readonly point: Vector3;
  readonly place: CanvasPlace;
}

/**
 * All labels of a Canvas. Places them after each frame, and queries the coverage of all of them
 * together on the GPU. At most one query is under way, and none without a new frame.
 */
export class LabelBoard {
  readonly #labels = new Set<BoardLabel>();
  readonly #viewOf: () => BoardView;
  #isFrameNoted = false;
  #isAsking = false;
  /** Whether a frame was drawn after the last query. */
  #isOutdated = false;
  #askedMs = Number.NEGATIVE_INFINITY;
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(viewOf: () => BoardView) {
    this.#viewOf = viewOf;
  }

  /** Adds a label until the returned function is called. */
  add(label: BoardLabel): () => void {
    this.#labels.add(label);
    return () => {
      this.#labels.delete(label);
      if (this.#labels.size > 0) return;
      clearTimeout(this.#timer);
      this.#timer = undefined;
    };
  }

  /** Call for each label before a frame is drawn, in the same task. */
  noteFrame(): void {
    if (this.#isFrameNoted) return;
    this.#isFrameNoted = true;
    // After the frame has updated the matrices, and before the browser paints.
    queueMicrotask(() => {
      this.#isFrameNoted = false;
      this.#placeAll();
      this.#isOutdated = true;
      this.#askSoon();
    });
  }

  #placeAll(): void {
    const seen = this.#seen().sort((a, b) => a.place.depthView - b.place.depthView);
    const hidden = new Set(this.#labels);
    for (const [rank, { label, place }] of seen.entries()) {
      hidden.delete(label);
      label.place(place.x, place.y, place.depthView, rank);
    }
    for (const label of hidden) label.leaveSight();
  }

  /** Labels whose points are in the image. */
  #seen(): SeenLabel[] {
    const { camera, size } = this.#viewOf();
    const seen: SeenLabel[] = [];
    for (const label of this.#labels) {
      const point = new Vector3().setFromMatrixPosition(label.object.matrixWorld);
      const place = placeOnCanvas(point, camera, size);
      if (place && isWithin(place.x, size.width) && isWithin(place.y, size.height))
        seen.push({ label, point, place });
    }
    return seen;
  }

  #askSoon(): void {
    if (this.#isAsking || this.#timer !== undefined || !this.#isOutdated || this.#labels.size === 0) return;
    const waitMs = Math.max(0, this.#askedMs + CHECK_INTERVAL_MS - performance.now());
    // Never within the frame.
    this.#timer = setTimeout(() => {
      this.#timer = undefined;
      void this.#ask();
    }, waitMs);
  }

  async #ask(): Promise<void> {
    const { renderer, scene, camera } = this.#viewOf();
    const asked = this.#seen().filter(({ label }) => label.canBeCovered);
    for (const label of this.#labels) if (!label.canBeCovered) label.cover(false);
    this.#isAsking = true;
    this.#isOutdated = false;
    this.#askedMs = performance.now();
    try {
      for (let from = 0; from < asked.length; from += LABELS_PER_QUESTION) {
        const part = asked.slice(from, from + LABELS_PER_QUESTION);
        const found = await coverageOf(renderer, scene, camera, part.map(pointOf));
        for (const [i, { label }] of part.entries()) {
          if (!this.#labels.has(label)) continue;
          const { opacity = 0, isBehindHost = false } = found?.[i] ?? {};
          label.cover(isBehindHost || opacity >= label.hideAt);
        }
      }
    } catch (error) {
      // The renderer reports a lost device. Labels stay as they are.
      if (!(error instanceof DestroyedError)) console.warn(error);
    } finally {
      this.#isAsking = false;
      this.#askSoon();
    }
  }
}

function isWithin(value: number, size: number): boolean {
  return value >= 0 && value <= size;
}

function pointOf({ point, place, label }: SeenLabel): PointToCover {
  return { point: [point.x, point.y, point.z], tolerance: label.tolerance ?? TOLERANCE * place.depthView };
}
