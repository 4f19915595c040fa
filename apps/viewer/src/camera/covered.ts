import type { Camera } from '@websplatter/core';
import { reprojected } from './reprojected.ts';

/** Covered part of the picture, from its right and bottom edge: of width and height, below 1. */
export interface Covered {
  readonly right: number;
  readonly bottom: number;
}

export const NOTHING_COVERED: Covered = { right: 0, bottom: 0 };

/** A sheet above this leaves too little to look at: the part of the picture under it stays. */
const MOST_COVERED = 0.7;
/** Time in which the picture goes where a panel that opens or closes leaves room for it. */
const GLIDE_MS = 200;

/** Part of the picture outside of a free area, by the sizes of both. */
export function coveredBeside(
  free: { readonly width: number; readonly height: number },
  picture: { readonly width: number; readonly height: number },
): Covered {
  const part = (freeLength: number, length: number) =>
    Math.min(MOST_COVERED, Math.max(0, 1 - freeLength / length));
  return { right: part(free.width, picture.width), bottom: part(free.height, picture.height) };
}

/** Width of the free area divided by its height, of a picture with this `aspect`. */
export function freeAspect(aspect: number, { right, bottom }: Covered): number {
  return (aspect * (1 - right)) / (1 - bottom);
}

/** The camera whose free area shows the image of `camera`, with its surroundings around it. */
export function besideCovered(camera: Camera, covered: Covered): Camera {
  const { right, bottom } = covered;
  if (right === 0 && bottom === 0) return camera;
  return reprojected(camera, [1 - right, 1 - bottom], [-right, bottom]);
}

/** Covered part as the picture follows it: not at once, but soon. */
export class CoveredGlide {
  #from = NOTHING_COVERED;
  #to = NOTHING_COVERED;
  #elapsedMs = GLIDE_MS;

  /** Where the picture is for now. */
  get now(): Covered {
    // Fast at first: a person who opens a panel looks there next.
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

  /** Glides `elapsedMs` further; returns whether it has not arrived. */
  update(elapsedMs: number): boolean {
    this.#elapsedMs = Math.min(GLIDE_MS, this.#elapsedMs + elapsedMs);
    return this.#elapsedMs < GLIDE_MS;
  }
}
