import { extname } from 'node:path';
import type { AccuracySettings, Detail, SortBy, SplatFormatName, Vec3 } from '@websplatter/core';
import { UsageError } from './input-error.ts';
import {
  accuracyOptions,
  byDefault,
  type CameraOptions,
  cameraOptions,
  checked,
  list,
  numbers,
  oneOf,
  parseArguments,
  SHARED,
  text,
} from './options.ts';

/** Arguments of `websplatter render`. */
export interface RenderOptions extends CameraOptions {
  readonly scenes: readonly string[];
  /** Format of all scenes; undefined: found by first bytes and names. */
  readonly format: SplatFormatName | undefined;
  /** One model matrix file per scene, or none at all. */
  readonly models: readonly string[];
  readonly widthPx: number;
  readonly heightPx: number;
  readonly out: string | undefined;
  readonly raw: string | undefined;
  /** Its name ends in one of `POSTER_EXTENSIONS`. */
  readonly poster: string | undefined;
  readonly renderer: 'gpu' | 'reference';
  readonly accuracy: AccuracySettings;
  /** The settings as the user wrote them. */
  readonly accuracyLabel: string;
  /** Time at which moving scenes are shown; undefined: their first. */
  readonly time: number | undefined;
  readonly sortBy: SortBy;
  readonly detail: Detail;
  /** sRGB, 0…1. */
  readonly background: Vec3;
  readonly frames: number;
  readonly timings: string | undefined;
}

/** Size of images if none is given. */
export const DEFAULT_SIZE = '1280x720';
const POSTER_EXTENSIONS = ['.jpg', '.jpeg', '.png'];

/** @throws UsageError or InvalidArgumentError that names the argument. */
export function parseRenderArguments(args: readonly string[]): RenderOptions {
  const { values, positionals } = parseArguments(
    args,
    {
      from: SHARED.from,
      camera: SHARED.camera,
      up: SHARED.up,
      model: list,
      size: byDefault(DEFAULT_SIZE, SHARED.size),
      out: text,
      raw: text,
      poster: checked(`a file whose name ends in ${POSTER_EXTENSIONS.join(' or ')}`, (path) =>
        POSTER_EXTENSIONS.includes(extname(path).toLowerCase()) ? path : undefined,
      ),
      renderer: byDefault('gpu', oneOf(['gpu', 'reference'], 'gpu or reference')),
      accuracy: text,
      set: list,
      time: SHARED.time,
      'sort-by': SHARED.sortBy,
      detail: SHARED.detail,
      background: byDefault(
        '0,0,0',
        numbers('r,g,b, each 0 to 1', (rgb) =>
          rgb.length === 3 && rgb.every((value) => value >= 0 && value <= 1)
            ? (rgb as unknown as Vec3)
            : undefined,
        ),
      ),
      frames: byDefault('1', SHARED.frames),
      timings: text,
    },
    (scenes) => {
      if (scenes.length === 0)
        throw new UsageError('SCENE', 'render needs a SCENE: a file, a URL or builtin:still-life');
    },
  );
  const { out, raw, poster, timings, model: models, renderer, detail, background, frames } = values;
  if (out === undefined && raw === undefined && poster === undefined) {
    throw new UsageError('--out', 'render needs --out image.png, --raw image.f32 or --poster image.jpg');
  }
  if (models.length !== 0 && models.length !== positionals.length) {
    const found = `${models.length} --model for ${positionals.length} scene${positionals.length === 1 ? '' : 's'}`;
    throw new UsageError('--model', `${found}; give one for each, in the order of the scenes, or none`);
  }
  if (renderer === 'reference' && detail !== 'full') {
    const message =
      '--renderer reference draws every splat, for it has no levels of detail; leave --detail out';
    throw new UsageError('--detail', message);
  }
  const [widthPx, heightPx] = values.size;
  return {
    ...{ scenes: positionals, format: values.from, ...cameraOptions(values), models, widthPx, heightPx },
    ...{ out, raw, poster, renderer, ...accuracyOptions(values.accuracy, values.set) },
    ...{ time: values.time, sortBy: values['sort-by'], detail, background, frames, timings },
  };
}
