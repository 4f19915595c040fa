import {
  type AccuracySettings,
  type AccuracyTarget,
  InvalidArgumentError,
  isAccuracyTarget,
  resolveAccuracy,
} from '@websplatter/core';
import { splitAccuracy } from '@websplatter/kit/split-accuracy';
import { isSameAccuracy, nearestPreset } from './accuracy.ts';

/**
 * For the address, `fast,sortKeyBits:32` or `minPsnrDb:45`; null for the device's default.
 *
 * @param unmentioned that default; null for an address that other devices must understand, which
 * then mentions all.
 */
export function encodeAccuracy(
  accuracy: AccuracySettings | AccuracyTarget,
  unmentioned: AccuracySettings | null = resolveAccuracy(),
): string | null {
  if (isAccuracyTarget(accuracy)) return Object.entries(accuracy)[0].join(':');
  if (unmentioned && isSameAccuracy(accuracy, unmentioned)) return null;
  const { preset, changed } = nearestPreset(accuracy);
  return [preset, ...changed.map((name) => `${name}:${accuracy[name]}`)].join(',');
}

/**
 * Reads the text of `encodeAccuracy`; null stands for the default.
 *
 * @throws InvalidArgumentError naming the preset or setting that does not exist, or its invalid
 * value.
 */
export function decodeAccuracy(text: string | null): AccuracySettings | AccuracyTarget {
  if (text === null) return resolveAccuracy();
  const { preset, asked } = splitAccuracy(text);
  if (!text.includes(',') && isAccuracyTarget(asked)) {
    // Text that is not a finite number stays a string; comparing it with 0 would coerce it.
    const [amount] = Object.values<unknown>(asked);
    if (typeof amount === 'number' && amount > 0) return asked;
    const message = `The target "${text}" has no number above 0; write minPsnrDb:45 for decibels or maxFrameMs:8 for milliseconds.`;
    throw new InvalidArgumentError('accuracy', message);
  }
  // Names and values may be wrong: resolveAccuracy checks them.
  return resolveAccuracy({ ...asked, preset });
}
