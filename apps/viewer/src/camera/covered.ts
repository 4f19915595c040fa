import type { Camera } from '@websplatter/core';
import { reprojected } from './reprojected.ts';

/** Fractions of the picture, below 1, that panels cover at its edges. */
export interface Covered {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}

export const NOTHING_COVERED: Covered = { left: 0, right: 0, top: 0, bottom: 0 };

/** Larger panels leave too little to look at: the picture keeps an area under them. */
const MOST_COVERED = 0.7;
/** Duration of the picture's move when a panel opens or closes, ms. */
const GLIDE_MS = 200;

/** Fractions of the picture outside of a free area, from the sizes of both. */
export function coveredBeside(
  free: { readonly left: number; readonly top: number; readonly width: number; readonly height: number },
  picture: { readonly width: number; readonly height: number },
): Covered {
  const part = (length: number, most = MOST_COVERED) => Math.min(most, Math.max(0, length));
  const right = part(1 - (free.left + free.width) / picture.width);
  const bottom = part(1 - (free.top + free.height) / picture.height);
  return {
    left: part(free.left / picture.width, MOST_COVERED - right),
    right,
    top: part(free.top / picture.height, MOST_COVERED - bottom),
    bottom,
  };
}

export function isSameCovered(a: Covered, b: Covered): boolean {
  return a.left === b.left && a.right === b.right && a.top === b.top && a.bottom === b.bottom;
}

/** Aspect ratio of the free area of a picture with this `aspect`. */
export function freeAspect(aspect: number, { left, right, top, bottom }: Covered): number {
  return (aspect * (1 - left - right)) / (1 - top - bottom);
}

/** The camera whose free area shows the image of `camera`, surrounded by more of the scene. */
export function besideCovered(camera: Camera, covered: Covered): Camera {
  if (isSameCovered(covered, NOTHING_COVERED)) return camera;
  const { left, right, top, bottom } = covered;
  return reprojected(camera, [1 - left - right, 1 - top - bottom], [left - right, bottom - top]);
}

/** Animates the covered fractions when panels open or close. */
export class CoveredGlide {
  #from = NOTHING_COVERED;
  #to = NOTHING_COVERED;
  #elapsedMs = GLIDE_MS;

  /** The fractions at this moment. */
  get now(): Covered {
    // Fast at first: a user who opens a panel looks there next.
    const remaining = (1 - this.#elapsedMs / GLIDE_MS) ** 3;
    if (remaining === 0) return this.#to;
    const between = (from: number, to: number) => to + remaining * (from - to);
    return {
      left: between(this.#from.left, this.#to.left),
      right: between(this.#from.right, this.#to.right),
      top: between(this.#from.top, this.#to.top),
      bottom: between(this.#from.bottom, this.#to.bottom),
    };
  }

  goTo(covered: Covered, isAtOnce: boolean): void {
    if (covered === this.#to && !isAtOnce) return;
    this.#from = this.now;
    this.#to = covered;
    this.#elapsedMs = isAtOnce ? GLIDE_MS : 0;
  }

  /** Advances by `elapsedMs`; returns whether the animation goes on. */
  update(elapsedMs: number): boolean {
    this.#elapsedMs = Math.min(GLIDE_MS, this.#elapsedMs + elapsedMs);
    return this.#elapsedMs < GLIDE_MS;
  }
}
