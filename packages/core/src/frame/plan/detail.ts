import { type AccuracyTarget, TARGETS } from '../../data/accuracy/accuracy-target.ts';
import { wrongArgument } from '../../data/given.ts';
import { hasSameFields } from '../../data/has-same-fields.ts';
import { isFiniteF32 } from '../../data/math/float-step.ts';

/**
 * Limits to a frame's level of detail: blobs, each of several merged splats, are drawn instead of all
 * splats. At least one limit is given; the tightest one applies.
 */
export interface DetailLimits {
  /**
   * Largest error in pixels of the layer, from 0 on: about how far blobs move the light of splats in the
   * middle of the image. At 0.5, pictures of captures are 30 to 55 dB from full ones. Farther clouds
   * save more (docs/detail.md).
   */
  readonly maxErrorPx?: number;
  /** Most splats and blobs, in all clouds together; a whole number from 1 on. */
  readonly maxSplats?: number;
  /**
   * Most splats and blobs, as a share of the splats in sight, above 0 and up to 1. From other
   * distances, PSNR changes less with the same share than with the same error or number.
   */
  readonly maxShare?: number;
}

/** Detail that a frame can be drawn with as it is. */
export type FixedDetail = 'full' | DetailLimits;

/**
 * How much of the clouds a frame shows. `full`: every splat. Limits: blobs where the limits allow
 * them. Otherwise the view finds the limits:
 *
 * - `{ maxFrameMs }`: while something moves, as many splats as the GPU draws in that time, by the
 *   times of the frames before, and in half the width and height if pixels take most of it; the
 *   picture at rest is full.
 * - `{ minPsnrDb }`: the fewest splats whose picture is that near to the full one by `reference`.
 *   The picture at rest is measured; moving pictures use the last measurement.
 * - `auto`: the `{ maxFrameMs }` of the frame's accuracy, or else of 60 frames a second. Scenes that
 *   draw in that time are therefore full.
 */
export type Detail = FixedDetail | AccuracyTarget | 'auto';

const LIMITS: Readonly<Record<keyof DetailLimits, (value: number) => boolean>> = {
  maxErrorPx: (value) => value >= 0,
  maxSplats: (value) => Number.isSafeInteger(value) && value > 0,
  maxShare: (value) => value > 0 && value <= 1,
};

/** Whether two details are the same, or two targets, or both null. */
export function isSameDetail<Value extends FixedDetail | AccuracyTarget>(
  a: Value | null,
  b: Value | null,
): boolean {
  return typeof a === 'object' && typeof b === 'object' ? hasSameFields<object>(a, b) : a === b;
}

/**
 * Whether a frame can be drawn with `detail` without being told more.
 *
 * @hidden Shared with the packages beside this one.
 */
export function isFixedDetail(detail: Detail): detail is FixedDetail {
  if (typeof detail === 'string') return detail === 'full';
  return TARGETS.every((name) => (detail as Partial<Record<string, number>>)[name] === undefined);
}

/** `12.5 %`, of a share. */
export function percentText(share: number): string {
  return `${Number((100 * share).toPrecision(3))} %`;
}

/**
 * @throws InvalidArgumentError unless `detail` is one.
 *
 * @hidden Shared with the packages beside this one.
 */
export function checkDetail(detail: Detail = 'full'): void {
  if (detail === 'full' || detail === 'auto') return;
  const given = Object.entries(Object(detail)).filter(([, value]) => value !== undefined);
  const areNumbers = given.every(([, value]) => isFiniteF32(value));
  const areLimits = given.every(
    ([name, value]) => Object.hasOwn(LIMITS, name) && LIMITS[name as keyof DetailLimits](value as number),
  );
  const isTarget =
    given.length === 1 && (TARGETS as readonly string[]).includes(given[0][0]) && (given[0][1] as number) > 0;
  if (given.length > 0 && areNumbers && (areLimits || isTarget)) return;
  const expected =
    "'full', 'auto', { minPsnrDb: 40 }, { maxFrameMs: 8 }, or limits: { maxErrorPx: 0.5 }, in pixels from 0 on, { maxSplats: 1e6 }, a whole number from 1 on, { maxShare: 0.5 }, above 0 and up to 1, or several of these";
  throw wrongArgument('detail', detail, expected);
}
