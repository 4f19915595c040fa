import { InvalidArgumentError } from '../errors.ts';
import type { Accuracy } from './accuracy.ts';

/** What is wanted of settings, instead of the settings: an error not to be passed, dB, or a time, milliseconds. */
export type AccuracyWish = { readonly minPsnrDb: number } | { readonly maxFrameMs: number };

/** Settings, or what is wanted of them: they are then measured and chosen for what is drawn. */
export type AccuracyRequest = Accuracy | AccuracyWish;

const WISHES = ['minPsnrDb', 'maxFrameMs'] as const;

/** Whether an outcome is asked for, rather than settings. */
export function isAccuracyWish(request: AccuracyRequest): request is AccuracyWish {
  return typeof request === 'object' && WISHES.some((name) => Object.hasOwn(request, name));
}

/** @throws InvalidArgumentError for a wish that is not one positive number under a name that is known. */
export function checkWish(wish: AccuracyWish): void {
  const [name, value] = Object.entries(wish)[0] ?? ['accuracy', undefined];
  const isKnown = (WISHES as readonly string[]).includes(name) && Object.keys(wish).length === 1;
  if (isKnown && typeof value === 'number' && value > 0) return;
  const found = JSON.stringify(wish);
  const message = `The wish is ${found}; it must be { minPsnrDb } in decibels or { maxFrameMs } in milliseconds, above 0.`;
  throw new InvalidArgumentError(name, message);
}

const known = new WeakMap<AccuracyWish, AccuracyWish>();
const interned = new Map<string, AccuracyWish>();

/**
 * The wish in `request`, one frozen object for all that are equal, or null where it asks for settings. An object is
 * looked at once; changing it later changes nothing.
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
