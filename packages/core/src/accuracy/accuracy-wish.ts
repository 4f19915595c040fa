import { InvalidArgumentError } from '../errors.ts';
import type { Accuracy } from './accuracy.ts';

/** An outcome requested instead of settings: a minimum PSNR in dB, or a maximum frame time in milliseconds. */
export type AccuracyWish = { readonly minPsnrDb: number } | { readonly maxFrameMs: number };

/** Settings, or a wish for which settings are measured and chosen. */
export type AccuracyRequest = Accuracy | AccuracyWish;

const WISHES = ['minPsnrDb', 'maxFrameMs'] as const;

/** Whether `request` is for an outcome rather than for settings. */
export function isAccuracyWish(request: AccuracyRequest): request is AccuracyWish {
  return typeof request === 'object' && WISHES.some((name) => Object.hasOwn(request, name));
}

/** @throws InvalidArgumentError unless the wish is one finite, positive number under a known name. */
export function checkWish(wish: AccuracyWish): void {
  const [name, value] = Object.entries(wish)[0] ?? ['accuracy', undefined];
  const isKnown = (WISHES as readonly string[]).includes(name) && Object.keys(wish).length === 1;
  if (isKnown && Number.isFinite(value) && value > 0) return;
  const found = JSON.stringify(wish);
  const message = `The wish is ${found}; it must be { minPsnrDb } in decibels or { maxFrameMs } in milliseconds, above 0.`;
  throw new InvalidArgumentError(name, message);
}

const known = new WeakMap<AccuracyWish, AccuracyWish>();
const interned = new Map<string, AccuracyWish>();

/**
 * Returns the wish in `request`, or null if it requests settings. Equal wishes are the same frozen object. An object is read
 * once; changing it later changes nothing.
 *
 * @throws InvalidArgumentError as `checkWish` does.
 */
export function internWish(request: AccuracyRequest): AccuracyWish | null {
  if (!isAccuracyWish(request)) return null;
  const found = known.get(request);
  if (found) return found;
  checkWish(request);
  const key = JSON.stringify(request);
  const wish = interned.get(key) ?? Object.freeze({ ...request });
  interned.set(key, wish);
  known.set(request, wish);
  return wish;
}
