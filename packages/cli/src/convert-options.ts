import { basename } from 'node:path';
import type { ShDegree, Vec3 } from '@websplatter/core';
import {
  AXIS_NAMES,
  type CropBox,
  multiplyQuaternions,
  rotationByDegrees,
  type SplatTransform,
  uprightRotation,
  WRITABLE_FORMATS,
  type WritableFormat,
  writableByName,
} from '@websplatter/core/write';
import { UsageError } from './input-error.ts';
import { parseStrictly } from './render-options.ts';

/** Arguments of `websplatter convert`. */
export interface ConvertOptions {
  readonly scenes: readonly string[];
  readonly out: string;
  readonly format: WritableFormat;
  /** Highest degree of harmonics to keep. */
  readonly shDegree: ShDegree | undefined;
  readonly transform: SplatTransform;
  /** Whether `--up` says which axis points up. */
  readonly isTurnedUp: boolean;
  /** In the space of the output. */
  readonly crop: CropBox | undefined;
  readonly json: boolean;
}

/** Options whose values may begin with a minus. */
const SIGNED_OPTIONS = ['--up', '--crop', '--translate', '--rotate', '--scale'];
const NO_ROTATION: Vec3 = [0, 0, 0];

/** @throws UsageError that names the argument. */
export function parseConvertArguments(args: readonly string[]): ConvertOptions {
  const { values, positionals } = parseStrictly(withJoinedValues(args), {
    format: { type: 'string' },
    sh: { type: 'string' },
    crop: { type: 'string' },
    up: { type: 'string' },
    translate: { type: 'string' },
    rotate: { type: 'string' },
    scale: { type: 'string' },
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
  if (values.up !== undefined && !AXIS_NAMES.includes(values.up)) {
    throw new UsageError('--up', `--up is ${values.up}; it must be one of ${AXIS_NAMES.join(', ')}`);
  }
  return {
    scenes,
    out,
    format: formatOf(values.format, out),
    shDegree: parseDegree(values.sh),
    transform: {
      rotation: multiplyQuaternions(
        rotationByDegrees(parseVector('--rotate', values.rotate) ?? NO_ROTATION),
        uprightRotation(values.up ?? 'y'),
      ),
      scale: parseScale(values.scale),
      translation: parseVector('--translate', values.translate),
    },
    isTurnedUp: values.up !== undefined,
    crop: parseBox(values.crop),
    json: values.json,
  };
}

/** Makes `--up -y` one argument, `--up=-y`: parsers take an initial minus for an option. */
function withJoinedValues(args: readonly string[]): string[] {
  const joined: string[] = [];
  for (const arg of args) {
    const before = joined.at(-1);
    if (before !== undefined && SIGNED_OPTIONS.includes(before) && /^-[\d.xyz]/.test(arg))
      joined[joined.length - 1] = `${before}=${arg}`;
    else joined.push(arg);
  }
  return joined;
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
  throw new UsageError('--format', `--format is ${name}; it must be one of ${names}`);
}

function parseDegree(text: string | undefined): ShDegree | undefined {
  if (text === undefined) return undefined;
  if (!/^[0-3]$/.test(text)) throw new UsageError('--sh', `--sh is ${text}; it must be 0, 1, 2 or 3`);
  return Number(text) as ShDegree;
}

function parseScale(text: string | undefined): number | undefined {
  if (text === undefined) return undefined;
  const [scale] = numbersOf(text);
  if (scale > 0 && numbersOf(text).length === 1) return scale;
  throw new UsageError('--scale', `--scale is ${text}; it must be a number above 0`);
}

function parseVector(option: string, text: string | undefined): Vec3 | undefined {
  if (text === undefined) return undefined;
  const numbers = numbersOf(text);
  if (numbers.length === 3) return numbers as [number, number, number];
  throw new UsageError(option, `${option} is ${text}; it must be x,y,z`);
}

function parseBox(text: string | undefined): CropBox | undefined {
  if (text === undefined) return undefined;
  const numbers = numbersOf(text);
  if (numbers.length !== 6)
    throw new UsageError('--crop', `--crop is ${text}; it must be minX,minY,minZ,maxX,maxY,maxZ`);
  const [minX, minY, minZ, maxX, maxY, maxZ] = numbers;
  return { min: [minX, minY, minZ], max: [maxX, maxY, maxZ] };
}

/** Numbers between commas; none at all if one is not finite. */
function numbersOf(text: string): number[] {
  const numbers = text.split(',').map((part) => (part.trim() === '' ? Number.NaN : Number(part)));
  return numbers.every(Number.isFinite) ? numbers : [];
}
