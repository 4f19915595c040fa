import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type AccuracyPreset,
  type AccuracySetting,
  type AccuracySettings,
  type AccuracyTarget,
  type Detail,
} from '@websplatter/core';
import { formatMany } from '@websplatter/kit/format';
import { type Drawn, nearestPreset, type SettingName } from '../state/accuracy.ts';

export type SettingValue = AccuracySettings[SettingName];

/** Formats a setting's value for the interface: `1/255`, `0.013`, `f16`. */
export function formatValue(value: SettingValue): string {
  if (typeof value !== 'number' || Number.isInteger(value)) return String(value);
  const denominator = Math.round(1 / value);
  const isUnitFraction = value < 0.05 && Math.abs(1 / value - denominator) < 1e-6 * denominator;
  return isUnitFraction ? `1/${denominator}` : String(Number(value.toPrecision(3)));
}

/** Plain words for setting values, of all settings together: no value has two meanings. */
const VALUE_WORDS: Readonly<Record<string, string>> = {
  f32: '32-bit',
  f16: '16-bit',
  u8: '8-bit',
  rgba32float: '32-bit',
  rgba16float: '16-bit',
  rgba8unorm: '8-bit',
  paper: 'as in the paper',
  opacity: 'by opacity',
  'bounding-box': 'by bounding box',
  frustum: 'by chunk only',
  auto: 'the faster',
};

/** Descriptions of the presets for the interface. */
export const PRESET_WORDS: Readonly<Record<AccuracyPreset, string>> = {
  reference: 'The exact picture: 32-bit numbers everywhere',
  high: 'Exact shapes and order; colours in 16 bits',
  balanced: 'Shapes and colours packed into fewer bytes',
  fast: '8-bit layers, and an order that is only nearly right',
  paper: 'As the WebSplatter paper describes it, to compare with',
};

/** A setting's value in plain words: `16-bit`, `1/128`, `by chunk only`. */
export function valueWords(name: SettingName, value: SettingValue): string {
  const { unit }: AccuracySetting<unknown> = ACCURACY_SETTINGS[name];
  if (unit === 'bits') return `${value}-bit`;
  return VALUE_WORDS[String(value)] ?? formatValue(value);
}

/** `balanced`, or `balanced, 16-bit sort keys`: the nearest preset and other settings. */
export function describeAccuracy(settings: AccuracySettings): string {
  const { preset, changed } = nearestPreset(settings);
  return [preset, ...changed.map((name) => describeSetting(name, settings))].join(', ');
}

/**
 * The plain name of measured settings: `fast`, `16-bit sort keys`, `paper, culling by chunk only`.
 * The engine calls them by the identifiers of its interface.
 */
export function describeMeasured({ name, settings, changed }: MeasuredSettings): string {
  if (Object.hasOwn(ACCURACY_PRESETS, name)) return name;
  // Variants differ from the base settings; the paper's variants differ from a preset.
  const isVariant = changed.length === 0 || name.startsWith('paper ');
  return isVariant
    ? describeAccuracy(settings)
    : changed.map((each) => describeSetting(each, settings)).join(', ');
}

/** Replaces the engine's names of measured settings in `text` by plain names. */
export function inPlainWords(text: string, measured: MeasuredSettings): string {
  return text.replaceAll(`“${measured.name}”`, `“${describeMeasured(measured)}”`);
}

interface MeasuredSettings {
  /** The engine's name. */
  readonly name: string;
  readonly settings: AccuracySettings;
  readonly changed: readonly SettingName[];
}

function describeSetting(name: SettingName, settings: AccuracySettings): string {
  const label = ACCURACY_SETTINGS[name].label.toLowerCase();
  const words = valueWords(name, settings[name]);
  return words.endsWith('-bit') ? `${words} ${label}` : `${label} ${words}`;
}

/** `at least 45 dB`, `at most 8 ms`. */
export function describeTarget(target: AccuracyTarget): string {
  return 'minPsnrDb' in target ? `at least ${target.minPsnrDb} dB` : `at most ${target.maxFrameMs} ms`;
}

/** Words for each limit or target of a detail. */
const NUMBERS: Readonly<Record<string, (value: number) => string>> = {
  maxErrorPx: (px) => `errors up to ${px} px`,
  maxSplats: (splats) => `at most ${formatMany(splats)} splats`,
  maxShare: (share) => `at most ${Number((100 * share).toPrecision(3))} % of the splats in sight`,
  maxFrameMs: (ms) => `splats for ${ms} ms`,
  minPsnrDb: (db) => `splats for ${db} dB`,
};

/** `at most 1.2 million splats`; empty for full detail. */
export function describeDetail(detail: Detail): string {
  if (typeof detail === 'string') return detail === 'full' ? '' : 'automatic detail';
  return Object.entries(detail)
    .map(([name, value]) => NUMBERS[name](value))
    .join(', ');
}

/** `balanced, at most 1.2 million splats`. */
export function describeDrawn({ accuracy, detail }: Drawn): string {
  return [describeAccuracy(accuracy), describeDetail(detail)].filter(Boolean).join(', ');
}
