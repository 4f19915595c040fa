import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type AccuracyPreset,
  type AccuracySettings,
  type AccuracyWish,
  DEFAULT_ACCURACY,
} from '@websplatter/core';

export type SettingName = keyof AccuracySettings;
export type SettingValue = AccuracySettings[SettingName];

export const SETTING_NAMES = Object.keys(ACCURACY_SETTINGS) as readonly SettingName[];
export const PRESET_NAMES = Object.keys(ACCURACY_PRESETS) as readonly AccuracyPreset[];

/** The preset that differs from `settings` in the fewest settings, and which those are; the default wins a tie. */
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

/** `balanced`, or `balanced, SH degree 1`: the nearest preset and what differs from it. */
export function describeAccuracy(settings: AccuracySettings): string {
  const { preset, changed } = nearestPreset(settings);
  const changes = changed.map((name) => `${ACCURACY_SETTINGS[name].label} ${formatValue(settings[name])}`);
  return [preset, ...changes].join(', ');
}

/** `at least 45 dB`, `at most 8 ms`. */
export function describeWish(wish: AccuracyWish): string {
  return 'minPsnrDb' in wish ? `at least ${wish.minPsnrDb} dB` : `at most ${wish.maxFrameMs} ms`;
}
