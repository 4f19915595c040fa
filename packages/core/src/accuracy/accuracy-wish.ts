import { InvalidArgumentError } from '../errors.ts';
import { shown } from '../printable.ts';
import { type Accuracy, type AccuracyPreset, type AccuracySettings, resolveAccuracy } from './accuracy.ts';

/** An outcome requested instead of settings: a minimum PSNR in dB, or a maximum frame time in milliseconds. */
export type AccuracyWish = { readonly minPsnrDb: number } | { readonly maxFrameMs: number };

/** Settings, or a wish for which settings are measured and chosen: one of both wishes, without settings. */
export type AccuracyRequest =
  | AccuracyPreset
  | (Exclude<Accuracy, AccuracyPreset> & { readonly minPsnrDb?: never; readonly maxFrameMs?: never })
  | { readonly minPsnrDb: number; readonly maxFrameMs?: never; readonly preset?: never }
  | { readonly maxFrameMs: number; readonly minPsnrDb?: never; readonly preset?: never };

const WISHES = ['minPsnrDb', 'maxFrameMs'] as const;

/** Whether `request` is for an outcome rather than for settings. */
export function isAccuracyWish(request: AccuracyRequest): request is AccuracyWish {
  return (
    typeof request === 'object' && request !== null && WISHES.some((name) => Object.hasOwn(request, name))
  );
}

/** @throws InvalidArgumentError unless the wish is one positive, finite number under a known name. */
export function checkWish(wish: AccuracyWish): void {
  const given: [string, unknown][] = Object.entries(wish);
  const [[name, value] = [], second] = given;
  const isKnown = (WISHES as readonly unknown[]).includes(name) && !second;
  if (isKnown && Number.isFinite(value) && (value as number) > 0) return;
  const found = given.map(([key, each]) => `${shown(key)}: ${shown(each)}`);
  const message = `The accuracy is { ${found.join(', ')} }; a wish is either { minPsnrDb } in decibels or { maxFrameMs } in milliseconds, finite and above 0.`;
  throw new InvalidArgumentError('accuracy', message);
}

/**
 * Returns the settings that `request` stands for, or null if it is a wish.
 *
 * @throws InvalidArgumentError for unknown settings, and for a wish that is not one positive, finite number.
 */
export function checkAccuracy(request: AccuracyRequest): AccuracySettings | null {
  if (!isAccuracyWish(request)) return resolveAccuracy(request);
  checkWish(request);
  return null;
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
