import { basename } from 'node:path';
import type { ShDegree, SplatFormatName, Vec3 } from '@websplatter/core';
import {
  AXIS_NAMES,
  type CropBox,
  rotationByDegrees,
  type SplatTransform,
  WRITABLE_FORMATS,
  type WritableFormat,
  writableByName,
} from '@websplatter/core/write';
import { AUTO } from './camera-options.ts';
import { UsageError, wrongValue } from './input-error.ts';
import { numbersOf, parseDegree, parseFormat, parseStrictly } from './render-options.ts';

/** Arguments of `websplatter convert`. */
export interface ConvertOptions {
  readonly scenes: readonly string[];
  /** Format of all scenes; undefined: found by first bytes and names. */
  readonly from: SplatFormatName | undefined;
  readonly out: string;
  readonly format: WritableFormat;
  /** Highest degree of harmonics to keep. */
  readonly shDegree: ShDegree | undefined;
  /** Once the scenes are upright. */
  readonly transform: SplatTransform;
  /** Name of the axis that points up, or `auto`: it is found; undefined: nothing is turned upright. */
  readonly up: string | undefined;
  /** In the space of the output. */
  readonly crop: CropBox | undefined;
  /** Folder of temporary files. */
  readonly temp: string | undefined;
  readonly json: boolean;
}

const NO_ROTATION: Vec3 = [0, 0, 0];

/** @throws UsageError that names the argument. */
export function parseConvertArguments(args: readonly string[]): ConvertOptions {
  const { values, positionals } = parseStrictly(args, {
    from: { type: 'string' },
    format: { type: 'string' },
    sh: { type: 'string' },
    crop: { type: 'string' },
    up: { type: 'string' },
    translate: { type: 'string' },
    rotate: { type: 'string' },
    scale: { type: 'string' },
    temp: { type: 'string' },
    merge: { type: 'boolean', default: false },
    json: { type: 'boolean', default: false },
  });
  if (positionals.length < 2) {
    throw new UsageError('OUT', `convert needs an IN and an OUT, found ${positionals.length} of them`);
  }
  const scenes = positionals.slice(0, -1);
  const out = positionals[positionals.length - 1];
  if (scenes.length > 1 && !values.merge) {
    throw new UsageError('--merge', `${scenes.length} scenes become one OUT only with --merge`);
  }
  if (values.up !== undefined && values.up !== AUTO && !AXIS_NAMES.includes(values.up)) {
    throw wrongValue('--up', values.up, `auto or one of ${AXIS_NAMES.join(', ')}`);
  }
  return {
    scenes,
    from: parseFormat(values.from),
    out,
    format: formatOf(values.format, out),
    shDegree: values.sh === undefined ? undefined : parseDegree('--sh', values.sh),
    transform: {
      rotation: rotationByDegrees(parseVector('--rotate', values.rotate) ?? NO_ROTATION),
      scale: parseScale(values.scale),
      translation: parseVector('--translate', values.translate),
    },
    up: values.up,
    crop: parseBox(values.crop),
    temp: values.temp,
    json: values.json,
  };
}

function formatOf(name: string | undefined, out: string): WritableFormat {
  if (name === undefined) {
    const format = writableByName(basename(out));
    if (format) return format;
    const ends = WRITABLE_FORMATS.map(({ extension }) => extension).join(', ');
    throw new UsageError('OUT', `OUT is ${out}; it must end with one of ${ends}, or have a --format`);
  }
  const format = WRITABLE_FORMATS.find((each) => each.name === name);
  if (format) return format;
  const names = WRITABLE_FORMATS.map((each) => each.name).join(', ');
  throw wrongValue('--format', name, `one of ${names}`);
}

function parseScale(text: string | undefined): number | undefined {
  if (text === undefined) return undefined;
  const [scale] = numbersOf(text);
  if (scale > 0 && numbersOf(text).length === 1) return scale;
  throw wrongValue('--scale', text, 'a number above 0');
}

function parseVector(option: string, text: string | undefined): Vec3 | undefined {
  if (text === undefined) return undefined;
  const numbers = numbersOf(text);
  if (numbers.length === 3) return numbers as [number, number, number];
  throw wrongValue(option, text, 'x,y,z');
}

function parseBox(text: string | undefined): CropBox | undefined {
  if (text === undefined) return undefined;
  const numbers = numbersOf(text);
  if (numbers.length !== 6) throw wrongValue('--crop', text, 'minX,minY,minZ,maxX,maxY,maxZ');
  const [minX, minY, minZ, maxX, maxY, maxZ] = numbers;
  return { min: [minX, minY, minZ], max: [maxX, maxY, maxZ] };
}
