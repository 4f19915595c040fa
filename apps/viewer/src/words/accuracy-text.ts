import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type AccuracyPreset,
  type AccuracySettings,
  type AccuracyWish,
  DEFAULT_ACCURACY,
  InvalidArgumentError,
  isAccuracyWish,
  resolveAccuracy,
} from '@websplatter/core';

/** Accuracy settings as the address and the interface write them. */

export type SettingName = keyof AccuracySettings;
export type SettingValue = AccuracySettings[SettingName];

export const SETTING_NAMES = Object.keys(ACCURACY_SETTINGS) as readonly SettingName[];
export const PRESET_NAMES = Object.keys(ACCURACY_PRESETS) as readonly AccuracyPreset[];

/** The preset that differs from `settings` in the fewest settings, and which those are; of equals the default. */
export function nearestPreset(settings: AccuracySettings): {
  readonly preset: AccuracyPreset;
  readonly changed: readonly SettingName[];
} {
  const candidates = PRESET_NAMES.map((preset) => ({
    preset,
    changed: SETTING_NAMES.filter((name) => settings[name] !== ACCURACY_PRESETS[preset][name]),
  }));
  const fewest = Math.min(...candidates.map(({ changed }) => changed.length));
  const best = candidates.filter(({ changed }) => changed.length === fewest);
  return best.find(({ preset }) => preset === DEFAULT_ACCURACY) ?? best[0];
}

export function isSameAccuracy(a: AccuracySettings, b: AccuracySettings): boolean {
  return SETTING_NAMES.every((name) => a[name] === b[name]);
}

/** `1/255`, `0.013`, `f16`: a value as people read it. */
export function formatValue(value: SettingValue): string {
  if (typeof value !== 'number' || Number.isInteger(value)) return String(value);
  const denominator = Math.round(1 / value);
  const isUnitFraction = value < 0.05 && Math.abs(1 / value - denominator) < 1e-6 * denominator;
  return isUnitFraction ? `1/${denominator}` : String(Number(value.toPrecision(3)));
}

/** `balanced`, or `balanced, SH degree 1`: settings in as few words as tell them from others. */
export function describeAccuracy(settings: AccuracySettings): string {
  const { preset, changed } = nearestPreset(settings);
  const changes = changed.map((name) => `${ACCURACY_SETTINGS[name].label} ${formatValue(settings[name])}`);
  return [preset, ...changes].join(', ');
}

/** `at least 45 dB`, `at most 8 ms`. */
export function describeWish(wish: AccuracyWish): string {
  return 'minPsnrDb' in wish ? `at least ${wish.minPsnrDb} dB` : `at most ${wish.maxFrameMs} ms`;
}

/** For the address, `fast,shDegree:1` or `minPsnrDb:45`; null for the default, which needs no mention. */
export function encodeAccuracy(accuracy: AccuracySettings | AccuracyWish): string | null {
  if (isAccuracyWish(accuracy)) return Object.entries(accuracy)[0].join(':');
  const { preset, changed } = nearestPreset(accuracy);
  if (preset === DEFAULT_ACCURACY && changed.length === 0) return null;
  return [preset, ...changed.map((name) => `${name}:${accuracy[name]}`)].join(',');
}

/**
 * Reads what `encodeAccuracy` wrote; null stands for the default.
 *
 * @throws InvalidArgumentError naming the preset or setting that does not exist, or the value that it cannot have.
 */
export function decodeAccuracy(text: string | null): AccuracySettings | AccuracyWish {
  if (text === null) return resolveAccuracy();
  const parts = text.split(',').map((part) => part.trim());
  // A first part with a colon is a change already: `shDegree:1` alone is a change of the default.
  const preset = parts[0].includes(':') ? DEFAULT_ACCURACY : parts.shift();
  const changes = parts.map((part) => {
    const [name, value = ''] = part.split(':');
    return [name, value !== '' && Number.isFinite(Number(value)) ? Number(value) : value];
  });
  const asked = Object.fromEntries(changes);
  if (!text.includes(',') && isAccuracyWish(asked)) {
    if (Object.values(asked)[0] > 0) return asked;
    const message = `The wish "${text}" has no number above 0; write minPsnrDb:45 for decibels or maxFrameMs:8 for milliseconds.`;
    throw new InvalidArgumentError('accuracy', message);
  }
  // Neither names nor values are known to be right: resolveAccuracy checks them.
  return resolveAccuracy({ ...asked, preset: preset as AccuracyPreset });
}

/** `address` with `accuracy` in its query, everything else as it was. */
export function addressWithAccuracy(address: URL, accuracy: AccuracySettings | AccuracyWish): string {
  const parameters = new URLSearchParams(address.search);
  const text = encodeAccuracy(accuracy);
  if (text === null) parameters.delete('accuracy');
  else parameters.set('accuracy', text);
  // Both may stand in a query as they are, and are easier to read so.
  const query = parameters.toString().replaceAll('%2C', ',').replaceAll('%3A', ':');
  return `${address.pathname}${query && `?${query}`}${address.hash}`;
}

/** Positions of a slider run from 0 to this. */
export const SLIDER_STEPS = 200;
/** Ranges whose ends are further apart than this are laid out by ratio: each step changes the value by as much. */
const LARGEST_LINEAR_RATIO = 20;

interface ValueRange {
  readonly min: number;
  readonly max: number;
}

/** The value at a slider's `position`, 0…SLIDER_STEPS, to three digits; both ends are exact. */
export function valueAt(position: number, { min, max }: ValueRange): number {
  if (position <= 0) return min;
  if (position >= SLIDER_STEPS) return max;
  const part = position / SLIDER_STEPS;
  const value = isByRatio({ min, max }) ? min * (max / min) ** part : min + (max - min) * part;
  return Math.min(max, Math.max(min, Number(value.toPrecision(3))));
}

/** The slider's position for `value`. */
export function positionOf(value: number, { min, max }: ValueRange): number {
  const part = isByRatio({ min, max })
    ? Math.log(value / min) / Math.log(max / min)
    : (value - min) / (max - min);
  return Math.round(part * SLIDER_STEPS);
}

function isByRatio({ min, max }: ValueRange): boolean {
  return min > 0 && max / min > LARGEST_LINEAR_RATIO;
}
