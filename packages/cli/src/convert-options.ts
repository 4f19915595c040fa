import { basename } from 'node:path';
import type { ShDegree, SplatFormatName, Vec3 } from '@websplatter/core';
import {
  AXIS_NAMES,
  type CropBox,
  type GradeOptions,
  rotationByDegrees,
  type SplatTransform,
  WRITABLE_FORMATS,
  type WritableFormat,
  writableByName,
} from '@websplatter/core/write';
import { UsageError } from './input-error.ts';
import { AUTO, byDefault, flag, numbers, oneOf, parseArguments, SHARED, text } from './options.ts';

/** Arguments of `websplatter convert`. */
export interface ConvertOptions {
  readonly scenes: readonly string[];
  /** Format of all scenes; undefined: found by first bytes and names. */
  readonly from: SplatFormatName | undefined;
  readonly out: string;
  readonly format: WritableFormat;
  /** Highest degree of harmonics to keep. */
  readonly shDegree: ShDegree | undefined;
  /** Time at which moving scenes are frozen; undefined: they stay moving. */
  readonly time: number | undefined;
  /** Once the scenes are upright. */
  readonly transform: SplatTransform;
  /** Name of the axis that points up, or `auto`: it is found; undefined: nothing is turned upright. */
  readonly up: string | undefined;
  /** In the space of the output. */
  readonly crop: CropBox | undefined;
  /** Written into the colours of what is left. */
  readonly grade: GradeOptions;
  /** Folder of temporary files. */
  readonly temp: string | undefined;
  /** Frames per second of a file of frames. */
  readonly framesPerS: number | undefined;
  readonly json: boolean;
}

/** Frames of a moving scene, one from each IN or from the files of a folder. */
export const FRAMES: WritableFormat = {
  ...{ name: 'frames', title: '.frames', extension: '.frames' },
  ...{ tellsAntialiased: true, hasYUp: false, hasMotion: false },
};
/** Formats of OUT, in the order of messages. */
export const OUT_FORMATS: readonly WritableFormat[] = [...WRITABLE_FORMATS, FRAMES];

const vector = numbers('x,y,z', (found) => (found.length === 3 ? (found as unknown as Vec3) : undefined));

/** An option with a number from `min` to `max`. */
const number = (min: number, max: number) =>
  numbers(`a number, ${min} to ${max}`, ([value, ...others]) =>
    value >= min && value <= max && others.length === 0 ? value : undefined,
  );

/** @throws UsageError that names the argument. */
export function parseConvertArguments(args: readonly string[]): ConvertOptions {
  const { values, positionals } = parseArguments(
    args,
    {
      from: SHARED.from,
      format: oneOf(OUT_FORMATS.map(({ name }) => name)),
      sh: SHARED.degree,
      time: SHARED.time,
      crop: numbers('minX,minY,minZ,maxX,maxY,maxZ', boxOf),
      up: oneOf([AUTO, ...AXIS_NAMES], `auto or one of ${AXIS_NAMES.join(', ')}`),
      translate: vector,
      rotate: byDefault('0,0,0', vector),
      scale: numbers('a number above 0', ([scale, ...others]) =>
        scale > 0 && others.length === 0 ? scale : undefined,
      ),
      exposure: number(-10, 10),
      saturation: number(0, 4),
      temperature: number(-1, 1),
      tint: number(-1, 1),
      fps: numbers('0.001 to 1000', ([rate, ...others]) =>
        rate >= 0.001 && rate <= 1000 && others.length === 0 ? rate : undefined,
      ),
      temp: text,
      merge: flag,
      json: flag,
    },
    (found) => {
      if (found.length < 2)
        throw new UsageError('OUT', `convert needs an IN and an OUT, found ${found.length} of them`);
    },
  );
  const { from, up, crop, scale, temp, json, exposure, saturation, temperature, tint } = values;
  const scenes = positionals.slice(0, -1);
  const out = positionals[positionals.length - 1];
  const format = formatOf(values.format, out);
  if (values.fps !== undefined && format !== FRAMES)
    throw new UsageError('--fps', `--fps is of frames, and OUT is ${out}; it must end with .frames`);
  if (scenes.length > 1 && !values.merge && format !== FRAMES) {
    throw new UsageError('--merge', `${scenes.length} scenes become one OUT only with --merge`);
  }
  return {
    ...{ scenes, from, out, format, shDegree: values.sh, framesPerS: values.fps },
    transform: { rotation: rotationByDegrees(values.rotate), scale, translation: values.translate },
    ...{ time: values.time, up, crop, temp, json, grade: { exposure, saturation, temperature, tint } },
  };
}

function formatOf(name: string | undefined, out: string): WritableFormat {
  const isFrames = name === undefined && basename(out).toLowerCase().endsWith(FRAMES.extension);
  const byName = isFrames ? FRAMES : writableByName(basename(out));
  const format = name === undefined ? byName : OUT_FORMATS.find((each) => each.name === name);
  if (format) return format;
  const ends = OUT_FORMATS.map(({ extension }) => extension).join(', ');
  throw new UsageError('OUT', `OUT is ${out}; it must end with one of ${ends}, or have a --format`);
}

function boxOf(found: readonly number[]): CropBox | undefined {
  if (found.length !== 6) return undefined;
  const [minX, minY, minZ, maxX, maxY, maxZ] = found;
  return { min: [minX, minY, minZ], max: [maxX, maxY, maxZ] };
}
