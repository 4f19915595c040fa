import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type AccuracyPreset,
  type AccuracySettings,
  DEFAULT_ACCURACY,
} from '@websplatter/core';

export type SettingName = keyof AccuracySettings;

export const SETTING_NAMES = Object.keys(ACCURACY_SETTINGS) as readonly SettingName[];
export const PRESET_NAMES = Object.keys(ACCURACY_PRESETS) as readonly AccuracyPreset[];

/** The preset nearest to `settings`, and the settings that differ; the default wins a tie. */
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
