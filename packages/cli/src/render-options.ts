import { extname } from 'node:path';
import { type ParseArgsConfig, parseArgs } from 'node:util';
import {
  ACCURACY_SETTINGS,
  type Accuracy,
  type AccuracySettings,
  checkDetail,
  DEFAULT_ACCURACY,
  type Detail,
  resolveAccuracy,
  type ShDegree,
  SORTED_BY,
  type SortBy,
  type SplatFormatName,
  type Vec3,
} from '@websplatter/core';
import { SPLAT_FORMATS } from '@websplatter/core/formats';
import { type CameraOptions, parseCameraOptions } from './camera-options.ts';
import { UsageError, wrongValue } from './input-error.ts';

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
  readonly sortBy: SortBy;
  readonly detail: Detail;
  /** sRGB, 0…1. */
  readonly background: Vec3;
  readonly frames: number;
  readonly timings: string | undefined;
}

const POSTER_EXTENSIONS = ['.jpg', '.jpeg', '.png'];

/** Size of images where none is given. */
export const DEFAULT_SIZE = '1280x720';
/** No GPU has larger textures. */
const MAX_SIZE_PX = 16384;

/** @throws UsageError or InvalidArgumentError that names the argument. */
export function parseRenderArguments(args: readonly string[]): RenderOptions {
  const { values, positionals } = parseStrictly(args, {
    from: { type: 'string' },
    camera: { type: 'string' },
    up: { type: 'string' },
    model: { type: 'string', multiple: true, default: [] },
    size: { type: 'string', default: DEFAULT_SIZE },
    out: { type: 'string' },
    raw: { type: 'string' },
    poster: { type: 'string' },
    renderer: { type: 'string', default: 'gpu' },
    accuracy: { type: 'string' },
    set: { type: 'string', multiple: true, default: [] },
    'sort-by': { type: 'string', default: 'auto' },
    detail: { type: 'string', default: 'full' },
    background: { type: 'string', default: '0,0,0' },
    frames: { type: 'string', default: '1' },
    timings: { type: 'string' },
  });
  if (positionals.length === 0)
    throw new UsageError('SCENE', 'render needs a SCENE: a file, a URL or builtin:still-life');
  const { poster } = values;
  if (values.out === undefined && values.raw === undefined && poster === undefined) {
    throw new UsageError('--out', 'render needs --out image.png, --raw image.f32 or --poster image.jpg');
  }
  if (poster !== undefined && !POSTER_EXTENSIONS.includes(extname(poster).toLowerCase())) {
    throw wrongValue('--poster', poster, `a file whose name ends in ${POSTER_EXTENSIONS.join(' or ')}`);
  }
  if (values.model.length !== 0 && values.model.length !== positionals.length) {
    const found = `${values.model.length} --model for ${positionals.length} scene${positionals.length === 1 ? '' : 's'}`;
    throw new UsageError('--model', `${found}; give one for each, in the order of the scenes, or none`);
  }
  const { renderer } = values;
  if (renderer !== 'gpu' && renderer !== 'reference') {
    throw wrongValue('--renderer', renderer, 'gpu or reference');
  }
  const detail = parseDetail(values.detail);
  if (renderer === 'reference' && detail !== 'full') {
    const message =
      '--renderer reference draws every splat, for it has no levels of detail; leave --detail out';
    throw new UsageError('--detail', message);
  }
  const [widthPx, heightPx] = parseSize(values.size);
  return {
    scenes: positionals,
    format: parseFormat(values.from),
    ...parseCameraOptions(values),
    models: values.model,
    widthPx,
    heightPx,
    out: values.out,
    raw: values.raw,
    poster,
    renderer,
    ...parseAccuracy(values.accuracy, values.set),
    sortBy: parseSortBy(values['sort-by']),
    detail,
    background: parseBackground(values.background),
    frames: parseFrames(values.frames),
    timings: values.timings,
  };
}

/**
 * `parseArgs` with one-line messages for unknown arguments, and for empty ones, which it accepts.
 *
 * @throws UsageError that names the argument.
 */
export function parseStrictly<Options extends NonNullable<ParseArgsConfig['options']>>(
  args: readonly string[],
  options: Options,
) {
  const parsed = parse(withJoinedValues(args), options);
  for (const token of parsed.tokens) {
    if (token.kind === 'option-terminator' || token.value !== '') continue;
    const name = token.kind === 'option' ? token.rawName : 'an argument';
    throw new UsageError(name, `${name} is empty`);
  }
  return parsed;
}

/** Options whose values may begin with a minus. */
const SIGNED_OPTIONS = ['--up', '--crop', '--translate', '--rotate', '--scale'];

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

function parse<Options extends NonNullable<ParseArgsConfig['options']>>(
  args: readonly string[],
  options: Options,
) {
  try {
    return parseArgs({ args: [...args], options, allowPositionals: true, strict: true, tokens: true });
  } catch (error) {
    const [firstSentence] = (error as Error).message.split(/\. |\n/);
    throw new UsageError('arguments', firstSentence.replace(/\.$/, ''));
  }
}

/** Parses `--from`. */
export function parseFormat(name: string | undefined): SplatFormatName | undefined {
  const names = SPLAT_FORMATS.map((format) => format.name);
  if (name === undefined || names.includes(name)) return name as SplatFormatName | undefined;
  throw wrongValue('--from', name, `one of ${names.join(', ')}`);
}

export function parseSize(text: string): [number, number] {
  const match = /^(\d+)[x×](\d+)$/i.exec(text);
  const size = match && [Number(match[1]), Number(match[2])];
  if (!size?.every((px) => px >= 1 && px <= MAX_SIZE_PX))
    throw wrongValue('--size', text, `WIDTHxHEIGHT in pixels, each 1 to ${MAX_SIZE_PX}`);
  return size as [number, number];
}

/** Parses the sort key of splats. */
export function parseSortBy(text: string): SortBy {
  const sortBy = SORTED_BY.find((each) => each === text);
  if (sortBy) return sortBy;
  throw wrongValue('--sort-by', text, SORTED_BY.join(' or '));
}

/** Parses how much of the scenes to show: `full`, `auto`, or names and numbers: `maxSplats=100000`. */
export function parseDetail(text: string): Detail {
  const parts = text.split(',').map((part) => splitOnce(part, '='));
  const detail = ['full', 'auto'].includes(text)
    ? text
    : Object.fromEntries(parts.map(([name, value]) => [name, value?.trim() ? Number(value) : Number.NaN]));
  try {
    checkDetail(detail as Detail);
  } catch {
    const expected =
      'takes full, auto, minPsnrDb=40, maxFrameMs=8, or maxErrorPx=0.5, maxSplats=100000 and maxShare=0.5, with commas between';
    throw new UsageError('--detail', `--detail ${text}: ${expected}`);
  }
  return detail as Detail;
}

/**
 * The line about frames of less than full detail; null for others.
 *
 * @param psnrDb as it was measured for the frame; null if it was not.
 */
export function detailText(
  detail: Detail,
  drawnSplats: number,
  loadedSplats: number,
  psnrDb: number | null = null,
): string | null {
  if (detail === 'full') return null;
  const written = (count: number) => count.toLocaleString('en');
  const limits: Readonly<Record<string, (value: number) => string>> = {
    maxErrorPx: (px) => `about ${px} px of error at most`,
    maxSplats: (count) => `at most ${written(count)} splats`,
    maxShare: (share) => `at most ${Number((100 * share).toPrecision(3))} % of the splats in sight`,
    minPsnrDb: (decibels) => `at least ${decibels} dB`,
    maxFrameMs: (ms) => `moving frames within ${ms} ms`,
  };
  const asked =
    detail === 'auto'
      ? 'moving frames as quick as screens'
      : Object.entries(detail)
          .map(([name, value]) => limits[name](value))
          .join(', ');
  const measured =
    psnrDb === null
      ? ''
      : `, ${psnrDb === Infinity ? 'equal to full detail' : `${psnrDb.toFixed(1)} dB measured`}`;
  return `${asked}: ${written(drawnSplats)} splats and blobs drawn for ${written(loadedSplats)} splats${measured}`;
}

function parseBackground(text: string): Vec3 {
  const numbers = numbersOf(text);
  if (numbers.length !== 3 || !numbers.every((value) => value >= 0 && value <= 1))
    throw wrongValue('--background', text, 'r,g,b, each 0 to 1');
  return numbers as [number, number, number];
}

/** Numbers between commas; none at all if one is not finite. */
export function numbersOf(text: string): number[] {
  const numbers = text.split(',').map((part) => (part.trim() === '' ? Number.NaN : Number(part)));
  return numbers.every(Number.isFinite) ? numbers : [];
}

export function parseDegree(option: string, text: string): ShDegree {
  if (!/^[0-3]$/.test(text)) throw wrongValue(option, text, '0, 1, 2 or 3');
  return Number(text) as ShDegree;
}

/** Parses a seed: a whole number. */
export function parseSeed(text: string): number {
  if (!/^\d{1,9}$/.test(text)) throw wrongValue('--seed', text, 'a whole number from 0 to 999999999');
  return Number(text);
}

export function parseFrames(text: string): number {
  if (!/^[1-9]\d{0,5}$/.test(text)) throw wrongValue('--frames', text, 'a whole number from 1 on');
  return Number(text);
}

/** The settings of `--accuracy` and `--set`. */
export function parseAccuracy(
  preset: string | undefined,
  assignments: readonly string[],
): Pick<RenderOptions, 'accuracy' | 'accuracyLabel'> {
  const accuracy = { ...(preset && { preset }), ...parseSettings(assignments) } as Accuracy;
  return {
    accuracy: resolveAccuracy(accuracy),
    accuracyLabel: [preset ?? DEFAULT_ACCURACY, ...assignments].join(' '),
  };
}

function parseSettings(assignments: readonly string[]): Record<string, unknown> {
  const settings: Record<string, unknown> = {};
  for (const assignment of assignments) {
    const [name, value] = splitOnce(assignment, '=');
    if (value === undefined) throw wrongValue('--set', assignment, 'name=value');
    settings[name] = isNumeric(name) ? parseNumber(value) : value;
  }
  return settings;
}

function isNumeric(name: string): boolean {
  if (!Object.hasOwn(ACCURACY_SETTINGS, name)) return false;
  const { values } = ACCURACY_SETTINGS[name as keyof AccuracySettings];
  return 'min' in values || typeof values[0] === 'number';
}

/** Parses a number or a fraction such as 1/255. Leaves other text to the setting's own check. */
function parseNumber(text: string): number | string {
  const [numerator, denominator = '1'] = splitOnce(text, '/');
  const value = Number(numerator) / Number(denominator);
  return numerator.trim() !== '' && Number.isFinite(value) ? value : text;
}

function splitOnce(text: string, separator: string): [string, string | undefined] {
  const at = text.indexOf(separator);
  return at < 0 ? [text, undefined] : [text.slice(0, at), text.slice(at + 1)];
}
