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
import { UsageError } from './input-error.ts';
import {
  byDefault,
  type CameraOptions,
  cameraOptions,
  checked,
  flag,
  numbers,
  oneOf,
  parseArguments,
  parsed,
  SHARED,
  text,
} from './options.ts';
import { DEFAULT_SIZE } from './render-options.ts';

const DEFAULT_PERCENTS = DETAIL_SHARES.map((share) => Math.round(100 * share));
/** Percent of the splats that are measured if no `--details` are given. */
export const DEFAULT_DETAILS = DEFAULT_PERCENTS.join(',');

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
  const { values, positionals } = parseArguments(
    args,
    {
      from: SHARED.from,
      camera: SHARED.camera,
      up: SHARED.up,
      size: byDefault(DEFAULT_SIZE, SHARED.size),
      'sort-by': SHARED.sortBy,
      detail: SHARED.detail,
      details: percents,
      distance: byDefault(
        '1',
        checked('a factor above 0', (found) => {
          const distance = Number(found);
          return distance > 0 && Number.isFinite(distance) ? distance : undefined;
        }),
      ),
      base: byDefault(DEFAULT_ACCURACY, oneOf(Object.keys(ACCURACY_PRESETS) as AccuracyPreset[])),
      settings: parsed(settingNames),
      frames: byDefault('15', SHARED.frames),
      json: flag,
      svg: text,
    },
    (scenes) => {
      if (scenes.length === 0)
        throw new UsageError('SCENE', 'accuracy needs a SCENE: a file, a URL or builtin:still-life');
    },
  );
  const { detail, distance, base, settings, frames, svg } = values;
  // Less detail is compared with the full scene, settings with the scene at their detail.
  const details = values.details ?? (detail === 'full' ? DEFAULT_PERCENTS : []);
  if (detail !== 'full' && details.length > 0) {
    const message = '--details are compared with the full scene; leave out --detail, or --details';
    throw new UsageError('--details', message);
  }
  const [widthPx, heightPx] = values.size;
  return {
    ...{ scenes: positionals, format: values.from, ...cameraOptions(values), widthPx, heightPx },
    ...{ sortBy: values['sort-by'], detail, detailShares: details.map((percent) => percent / 100) },
    ...{ distance, base, settings, frames, isJson: values.json, svg },
  };
}

const eachPercent = numbers(
  `none, or percent of the splats, each above 0 and below 100, such as ${DEFAULT_DETAILS}`,
  (found) => (found.every((percent) => percent > 0 && percent < 100) ? found : undefined),
);

/** Percents of the splats; none for `none`. */
const percents: typeof eachPercent = {
  ...eachPercent,
  read: (found, option) => (found === 'none' ? [] : eachPercent.read(found, option)),
};

function settingNames(found: string, option: string): readonly string[] {
  const names = found.split(',').map((name) => name.trim());
  const unknown = names.find((name) => !Object.hasOwn(ACCURACY_SETTINGS, name));
  if (unknown === undefined) return names;
  const known = Object.keys(ACCURACY_SETTINGS).join(', ');
  throw new UsageError(option, `${option} names “${unknown}”; there are ${known}`);
}
