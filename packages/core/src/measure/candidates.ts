import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type Accuracy,
  type AccuracyPreset,
  type AccuracySettings,
  internAccuracy,
} from '../data/accuracy/accuracy.ts';
import { InvalidArgumentError } from '../data/errors.ts';
import { SH_PRECISIONS } from '../data/packing/precision.ts';
import type { Detail, FixedDetail } from '../frame/plan/detail.ts';
import { describeDetail } from './details.ts';

/** Name of one setting. */
export type SettingName = keyof AccuracySettings;

/** Settings to measure. */
export interface Candidate {
  /** A preset's name, or the differences from the base. */
  readonly name: string;
  readonly settings: AccuracySettings;
  /** Names of the settings that differ from the base. */
  readonly changed: readonly SettingName[];
  readonly detail: Detail;
}

const SETTING_NAMES = Object.keys(ACCURACY_SETTINGS) as SettingName[];

/** Values to try of settings that are ranges, or that only some clouds have. */
const TRIED: { readonly [Name in SettingName]?: readonly AccuracySettings[Name][] } = {
  alphaCutoff: [1 / 255, 1 / 128, 1 / 64],
  resolutionScale: [1, 0.5],
  // Few files have a palette.
  shPrecision: ['f32', 'f16', 'u8'],
};

/** The paper's pipeline with one of its optimizations switched off. */
const ABLATIONS: Readonly<Record<string, Partial<AccuracySettings>>> = {
  'paper −CULL': { culling: 'frustum' },
  'paper −RADIUS': { extent: 'fixed' },
};

/**
 * Lists the base, the presets, the paper's ablations if `withAblations`, and the base with one
 * setting of `names` changed at a time. Equal settings occur once, under the first of their names.
 *
 * @param withPalettes whether to list harmonics as a palette.
 * @param detail level of detail of all candidates.
 * @throws InvalidArgumentError for an unknown setting.
 */
export function singleCandidates(
  base: Accuracy,
  names: readonly string[] = SETTING_NAMES,
  withAblations = true,
  withPalettes = false,
  detail: Detail = 'full',
): Candidate[] {
  const baseSettings = internAccuracy(base);
  const chosen = names.map((name) => {
    if ((SETTING_NAMES as string[]).includes(name)) return name as SettingName;
    const message = `There is no accuracy setting "${name}"; use one of ${SETTING_NAMES.join(', ')}.`;
    throw new InvalidArgumentError('settings', message);
  });
  const presets = Object.keys(ACCURACY_PRESETS) as AccuracyPreset[];
  const found: Candidate[] = [
    { name: nameOfBase(base), settings: baseSettings, changed: [], detail },
    ...presets.map((name) => candidate(baseSettings, detail, internAccuracy(name), name)),
    ...Object.entries(withAblations ? ABLATIONS : {}).map(([name, changes]) =>
      candidate(baseSettings, detail, internAccuracy({ preset: 'paper', ...changes }), name),
    ),
    ...chosen.flatMap((name) =>
      valuesTried(name, withPalettes).map((value) =>
        candidate(baseSettings, detail, changedTo(baseSettings, name, value)),
      ),
    ),
  ];
  const first = new Map<AccuracySettings, Candidate>();
  for (const each of found) if (!first.has(each.settings)) first.set(each.settings, each);
  return [...first.values()];
}

/** Returns the base with all of `changes` as a candidate. */
export function combined({ settings, detail }: Candidate, changes: Partial<AccuracySettings>): Candidate {
  return candidate(settings, detail, internAccuracy({ ...settings, ...changes }));
}

/** Lists the base with each of `details`. */
export function detailCandidates(base: Accuracy, details: readonly FixedDetail[]): Candidate[] {
  const settings = internAccuracy(base);
  return details.map((detail) => ({ name: describeDetail(detail), settings, changed: [], detail }));
}

/** Describes a setting for people: `sortKeyBits 16`, `alphaCutoff 1/128`. */
function describeSetting(settings: AccuracySettings, name: SettingName): string {
  const value = settings[name];
  const isFraction = name === 'alphaCutoff' && typeof value === 'number';
  // Cutoffs are usually written as fractions: 1/255 is one step of eight bits.
  return `${name} ${isFraction ? `1/${Number((1 / value).toPrecision(4))}` : value}`;
}

function candidate(
  base: AccuracySettings,
  detail: Detail,
  settings: AccuracySettings,
  name?: string,
): Candidate {
  const changed = SETTING_NAMES.filter((setting) => settings[setting] !== base[setting]);
  const described = changed.map((setting) => describeSetting(settings, setting)).join(', ');
  return { name: name ?? described, settings, changed, detail };
}

function valuesTried(name: SettingName, withPalettes: boolean): readonly AccuracySettings[SettingName][] {
  const { values } = ACCURACY_SETTINGS[name];
  if (name === 'shPrecision' && withPalettes) return SH_PRECISIONS;
  return TRIED[name] ?? ('min' in values ? [values.max, values.min] : values);
}

function changedTo(
  base: AccuracySettings,
  name: SettingName,
  value: AccuracySettings[SettingName],
): AccuracySettings {
  return internAccuracy({ ...base, [name]: value });
}

function nameOfBase(base: Accuracy): string {
  if (typeof base === 'string') return base;
  const settings = internAccuracy(base);
  const presets = Object.keys(ACCURACY_PRESETS) as AccuracyPreset[];
  const preset = presets.find((name) => internAccuracy(name) === settings);
  return preset ?? 'base';
}
