import type { Camera } from '@websplatter/core';
import { reprojected } from './reprojected.ts';

/** Fractions of the picture, below 1, that panels cover at its right and bottom edge. */
export interface Covered {
  readonly right: number;
  readonly bottom: number;
}

export const NOTHING_COVERED: Covered = { right: 0, bottom: 0 };

/** A higher sheet leaves too little to look at: the picture keeps the area under it. */
const MOST_COVERED = 0.7;
/** Duration of the picture's move when a panel opens or closes, ms. */
const GLIDE_MS = 200;

/** Fractions of the picture outside of a free area, from the sizes of both. */
export function coveredBeside(
  free: { readonly width: number; readonly height: number },
  picture: { readonly width: number; readonly height: number },
): Covered {
  const part = (freeLength: number, length: number) =>
    Math.min(MOST_COVERED, Math.max(0, 1 - freeLength / length));
  return { right: part(free.width, picture.width), bottom: part(free.height, picture.height) };
}

/** Aspect ratio of the free area of a picture with this `aspect`. */
export function freeAspect(aspect: number, { right, bottom }: Covered): number {
  return (aspect * (1 - right)) / (1 - bottom);
}

/** The camera whose free area shows the image of `camera`, surrounded by more of the scene. */
export function besideCovered(camera: Camera, covered: Covered): Camera {
  const { right, bottom } = covered;
  if (right === 0 && bottom === 0) return camera;
  return reprojected(camera, [1 - right, 1 - bottom], [-right, bottom]);
}

/** Animates the covered fractions when panels open or close. */
export class CoveredGlide {
  #from = NOTHING_COVERED;
  #to = NOTHING_COVERED;
  #elapsedMs = GLIDE_MS;

  /** The fractions at this moment. */
  get now(): Covered {
    // Fast at first: a user who opens a panel looks there next.
    const left = (1 - this.#elapsedMs / GLIDE_MS) ** 3;
    if (left === 0) return this.#to;
    const between = (from: number, to: number) => to + left * (from - to);
    return {
      right: between(this.#from.right, this.#to.right),
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
