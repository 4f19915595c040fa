import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type AccuracyPreset,
  DEFAULT_ACCURACY,
  type Detail,
  type SortBy,
} from '@websplatter/core';
import { UsageError, wrongValue } from './input-error.ts';
import { parseDetail, parseFrames, parseSize, parseSortBy, parseStrictly } from './render-options.ts';

/** Arguments of `websplatter accuracy`. */
export interface AccuracyOptions {
  readonly scenes: readonly string[];
  readonly camera: string;
  readonly widthPx: number;
  readonly heightPx: number;
  readonly sortBy: SortBy;
  readonly detail: Detail;
  readonly base: AccuracyPreset;
  /** Names of the settings to change; undefined means all. */
  readonly settings: readonly string[] | undefined;
  /** Measured frames per point. */
  readonly frames: number;
  readonly isJson: boolean;
  readonly svg: string | undefined;
}

/** @throws UsageError that names the argument. */
export function parseAccuracyArguments(args: readonly string[]): AccuracyOptions {
  const { values, positionals } = parseStrictly(args, {
    camera: { type: 'string' },
    size: { type: 'string' },
    'sort-by': { type: 'string', default: 'auto' },
    detail: { type: 'string', default: 'full' },
    base: { type: 'string', default: DEFAULT_ACCURACY },
    settings: { type: 'string' },
    frames: { type: 'string', default: '15' },
    json: { type: 'boolean', default: false },
    svg: { type: 'string' },
  });
  if (positionals.length === 0)
    throw new UsageError('SCENE', 'accuracy needs a SCENE: a file, a URL or builtin:still-life');
  if (values.camera === undefined) throw new UsageError('--camera', 'accuracy needs --camera CAM.json');
  if (values.size === undefined) throw new UsageError('--size', 'accuracy needs --size WIDTHxHEIGHT');
  const [widthPx, heightPx] = parseSize(values.size);
  return {
    scenes: positionals,
    camera: values.camera,
    widthPx,
    heightPx,
    sortBy: parseSortBy(values['sort-by']),
    detail: parseDetail(values.detail),
    base: parseBase(values.base),
    settings: parseNames(values.settings),
    frames: parseFrames(values.frames),
    isJson: values.json,
    svg: values.svg,
  };
}

function parseBase(text: string): AccuracyPreset {
  if (Object.hasOwn(ACCURACY_PRESETS, text)) return text as AccuracyPreset;
  throw wrongValue('--base', text, `one of ${Object.keys(ACCURACY_PRESETS).join(', ')}`);
}

function parseNames(text: string | undefined): string[] | undefined {
  const names = text?.split(',').map((name) => name.trim());
  const unknown = names?.find((name) => !Object.hasOwn(ACCURACY_SETTINGS, name));
  if (unknown === undefined) return names;
  const known = Object.keys(ACCURACY_SETTINGS).join(', ');
  throw new UsageError('--settings', `--settings names “${unknown}”; there are ${known}`);
}
