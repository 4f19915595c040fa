import { InvalidArgumentError } from '../errors.ts';
import { shown } from '../printable.ts';
import { type Accuracy, type AccuracyPreset, type AccuracySettings, resolveAccuracy } from './accuracy.ts';

/** Outcome requested instead of settings: a minimum PSNR in dB, or a maximum frame time in ms. */
export type AccuracyTarget = { readonly minPsnrDb: number } | { readonly maxFrameMs: number };

/** Settings, or one target for which settings are measured and chosen. */
export type AccuracyRequest =
  | AccuracyPreset
  | (Exclude<Accuracy, AccuracyPreset> & { readonly minPsnrDb?: never; readonly maxFrameMs?: never })
  | { readonly minPsnrDb: number; readonly maxFrameMs?: never; readonly preset?: never }
  | { readonly maxFrameMs: number; readonly minPsnrDb?: never; readonly preset?: never };

/** Names of targets. */
export const TARGETS = ['minPsnrDb', 'maxFrameMs'] as const;

/**
 * Whether `request` is for an outcome rather than for settings.
 *
 * @example
 * const isMeasured = isAccuracyTarget({ minPsnrDb: 45 }); // true
 */
export function isAccuracyTarget(request: AccuracyRequest): request is AccuracyTarget {
  return (
    typeof request === 'object' && request !== null && TARGETS.some((name) => Object.hasOwn(request, name))
  );
}

/**
 * @throws InvalidArgumentError unless the target is one positive, finite number under a known name.
 */
export function checkTarget(target: AccuracyTarget): void {
  const given: [string, unknown][] = Object.entries(target);
  const [[name, value] = [], second] = given;
  const isKnown = (TARGETS as readonly unknown[]).includes(name) && !second;
  if (isKnown && Number.isFinite(value) && (value as number) > 0) return;
  const found = given.map(([key, each]) => `${shown(key)}: ${shown(each)}`);
  const message = `The accuracy is { ${found.join(', ')} }; a target is either { minPsnrDb } in decibels or { maxFrameMs } in milliseconds, finite and above 0.`;
  throw new InvalidArgumentError('accuracy', message);
}

/**
 * Returns the settings that `request` stands for, or null if it is a target.
 *
 * @throws InvalidArgumentError for unknown settings, and for a target that is not one positive,
 *   finite number.
 * @example
 * const settings = checkAccuracy('high');
 * const bits = settings?.sortKeyBits;
 */
export function checkAccuracy(request: AccuracyRequest): AccuracySettings | null {
  if (!isAccuracyTarget(request)) return resolveAccuracy(request);
  checkTarget(request);
  return null;
}

const known = new WeakMap<AccuracyTarget, AccuracyTarget>();
const interned = new Map<string, AccuracyTarget>();

/**
 * Returns the target in `request`, or null if it requests settings. Equal targets are the same
 * frozen object. An object is read once; changing it later changes nothing.
 *
 * @throws InvalidArgumentError as `checkTarget` does.
 */
export function internTarget(request: AccuracyRequest): AccuracyTarget | null {
  if (!isAccuracyTarget(request)) return null;
  const found = known.get(request);
  if (found) return found;
  checkTarget(request);
  const key = JSON.stringify(request);
  const target = interned.get(key) ?? Object.freeze({ ...request });
  interned.set(key, target);
  known.set(request, target);
  return target;
}
