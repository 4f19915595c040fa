import {
  ACCURACY_PRESETS,
  ACCURACY_SETTINGS,
  type AccuracyPreset,
  DEFAULT_ACCURACY,
  type Detail,
  type SortBy,
  type SplatFormatName,
} from '@websplatter/core';
import { DETAIL_SHARES } from '@websplatter/core/measure';
import { type CameraOptions, parseCameraOptions } from './camera-options.ts';
import { UsageError, wrongValue } from './input-error.ts';
import {
  DEFAULT_SIZE,
  numbersOf,
  parseDetail,
  parseFormat,
  parseFrames,
  parseSize,
  parseSortBy,
  parseStrictly,
} from './render-options.ts';

/** Percent of the splats that are measured where no `--details` are given. */
export const DEFAULT_DETAILS = DETAIL_SHARES.map((share) => Math.round(100 * share)).join(',');

/** Arguments of `websplatter accuracy`. */
export interface AccuracyOptions extends CameraOptions {
  readonly scenes: readonly string[];
  /** Format of all scenes; undefined: found by first bytes and names. */
  readonly format: SplatFormatName | undefined;
  readonly widthPx: number;
  readonly heightPx: number;
  readonly sortBy: SortBy;
  readonly detail: Detail;
  /** Shares of the splats that are measured besides, with the base's settings. */
  readonly detailShares: readonly number[];
  /** Moves the camera to so many times its distance from the scene. */
  readonly distance: number;
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
    from: { type: 'string' },
    camera: { type: 'string' },
    up: { type: 'string' },
    size: { type: 'string', default: DEFAULT_SIZE },
    'sort-by': { type: 'string', default: 'auto' },
    detail: { type: 'string', default: 'full' },
    details: { type: 'string' },
    distance: { type: 'string', default: '1' },
    base: { type: 'string', default: DEFAULT_ACCURACY },
    settings: { type: 'string' },
    frames: { type: 'string', default: '15' },
    json: { type: 'boolean', default: false },
    svg: { type: 'string' },
  });
  if (positionals.length === 0)
    throw new UsageError('SCENE', 'accuracy needs a SCENE: a file, a URL or builtin:still-life');
  const [widthPx, heightPx] = parseSize(values.size);
  const detail = parseDetail(values.detail);
  // Less detail is compared with the full scene, settings with the scene at their detail.
  const detailShares = parseShares(values.details ?? (detail === 'full' ? DEFAULT_DETAILS : 'none'));
  if (detail !== 'full' && detailShares.length > 0) {
    const message = '--details are compared with the full scene; leave out --detail, or --details';
    throw new UsageError('--details', message);
  }
  return {
    scenes: positionals,
    format: parseFormat(values.from),
    ...parseCameraOptions(values),
    widthPx,
    heightPx,
    sortBy: parseSortBy(values['sort-by']),
    detail,
    detailShares,
    distance: parseDistance(values.distance),
    base: parseBase(values.base),
    settings: parseNames(values.settings),
    frames: parseFrames(values.frames),
    isJson: values.json,
    svg: values.svg,
  };
}

function parseShares(text: string): number[] {
  if (text === 'none') return [];
  const percents = numbersOf(text);
  if (percents.length > 0 && percents.every((percent) => percent > 0 && percent < 100))
    return percents.map((percent) => percent / 100);
  const expected = `none, or percent of the splats, each above 0 and below 100, such as ${DEFAULT_DETAILS}`;
  throw wrongValue('--details', text, expected);
}

function parseDistance(text: string): number {
  const distance = text.trim() === '' ? Number.NaN : Number(text);
  if (distance > 0 && Number.isFinite(distance)) return distance;
  throw wrongValue('--distance', text, 'a factor above 0');
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
