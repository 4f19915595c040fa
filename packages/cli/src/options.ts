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
  type SplatFormatName,
  type Vec3,
} from '@websplatter/core';
import { SPLAT_FORMATS } from '@websplatter/core/formats';
import { UsageError, wrongValue } from './input-error.ts';

type Found = string | boolean | readonly (string | boolean)[] | undefined;

/** An option of a command. */
export interface Option<Value> {
  readonly type: 'string' | 'boolean';
  /** Whether it may be repeated. */
  readonly multiple?: boolean;
  /**
   * The value for the text that was found on the command line; for undefined, the default.
   *
   * @throws UsageError that names the option.
   */
  readonly read: (found: Found, option: string) => Value;
}

/** True if the option is there. */
export const flag: Option<boolean> = { type: 'boolean', read: (found) => found === true };

/** All texts of an option that may be repeated. */
export const list: Option<readonly string[]> = {
  type: 'string',
  multiple: true,
  read: (found = []) => found as readonly string[],
};

/** An option whose text `parse` turns into the value; `parse` throws UsageError for a wrong text. */
export function parsed<Value>(parse: (text: string, option: string) => Value): Option<Value | undefined> {
  return {
    type: 'string',
    read: (found, option) => (found === undefined ? undefined : parse(found as string, option)),
  };
}

export const text: Option<string | undefined> = parsed((found) => found);

/** An option with a check: `parse` returns undefined for texts that are not as `expected` says. */
export function checked<Value>(
  expected: string,
  parse: (text: string) => Value | undefined,
): Option<Value | undefined> {
  return parsed((found, option) => {
    const value = parse(found);
    if (value === undefined) throw wrongValue(option, found, expected);
    return value;
  });
}

/** An option with one of `values`, which messages list as in “one of a, b”. */
export function oneOf<const Value extends string>(
  values: readonly Value[],
  expected = `one of ${values.join(', ')}`,
): Option<Value | undefined> {
  return checked(expected, (found) => values.find((value) => value === found));
}

/** An option that has the value of `initial` if it is not there. */
export function byDefault<Value>(initial: string, option: Option<Value | undefined>): Option<Value> {
  return { ...option, read: (found = initial, name) => option.read(found, name) as Value };
}

/** An option with numbers between commas. */
export function numbers<Value>(
  expected: string,
  read: (numbers: readonly number[]) => Value | undefined,
): Option<Value | undefined> {
  return checked(expected, (found) => {
    const each = found.split(',').map((part) => (part.trim() === '' ? Number.NaN : Number(part)));
    return each.every(Number.isFinite) ? read(each) : undefined;
  });
}

/** Asks for a camera or an axis that is found. */
export const AUTO = 'auto';
/** No GPU has larger textures. */
const MAX_SIZE_PX = 16384;

const AXES: Readonly<Record<string, Vec3>> = {
  x: [1, 0, 0],
  '-x': [-1, 0, 0],
  y: [0, 1, 0],
  '-y': [0, -1, 0],
  z: [0, 0, 1],
  '-z': [0, 0, -1],
};

/** Options that several commands have. */
export const SHARED = {
  /** Format of all scenes; undefined: found by first bytes and names. */
  from: oneOf(SPLAT_FORMATS.map(({ name }) => name as SplatFormatName)),
  /** Path of a camera file, or `auto`: a camera is found for the scenes. */
  camera: byDefault(AUTO, text),
  /** Time at which moving scenes are shown or frozen; undefined: their first, or not frozen. */
  time: numbers('a number', ([time, ...others]) => (others.length === 0 ? time : undefined)),
  /** Up for a camera that is found; null: found, too. */
  up: checked(`auto or one of ${Object.keys(AXES).join(', ')}`, (found) =>
    found === AUTO ? null : Object.hasOwn(AXES, found) ? AXES[found] : undefined,
  ),
  /** Width and height in pixels. */
  size: checked(`WIDTHxHEIGHT in pixels, each 1 to ${MAX_SIZE_PX}`, (found): [number, number] | undefined => {
    const [, width, height] = /^(\d+)[x×](\d+)$/i.exec(found) ?? [];
    const size: [number, number] = [Number(width), Number(height)];
    return size.every((px) => px >= 1 && px <= MAX_SIZE_PX) ? size : undefined;
  }),
  sortBy: byDefault('auto', oneOf(SORTED_BY, SORTED_BY.join(' or '))),
  /** How much of the scenes to show: `full`, `auto`, or names and numbers: `maxSplats=100000`. */
  detail: byDefault('full', parsed(detailOf)),
  frames: checked('a whole number from 1 on', (found) =>
    /^[1-9]\d{0,5}$/.test(found) ? Number(found) : undefined,
  ),
  seed: checked('a whole number from 0 to 999999999', (found) =>
    /^\d{1,9}$/.test(found) ? Number(found) : undefined,
  ),
  degree: checked('0, 1, 2 or 3', (found) =>
    /^[0-3]$/.test(found) ? (Number(found) as ShDegree) : undefined,
  ),
} as const;

/**
 * Parses the arguments of a command. Options without a value are undefined, unless they have a
 * default.
 *
 * @param options by name.
 * @param checkPositionals throws UsageError for a wrong number of other arguments, before options
 *   are checked.
 * @throws UsageError that names the argument.
 */
export function parseArguments<Values>(
  args: readonly string[],
  options: { readonly [Name in keyof Values]: Option<Values[Name]> },
  checkPositionals: (positionals: readonly string[]) => void = () => {},
): { readonly values: Values; readonly positionals: readonly string[] } {
  const definitions = Object.entries<Option<unknown>>(options);
  const config = definitions.map(([name, { type, multiple = false }]) => [name, { type, multiple }]);
  const found = parseStrictly(args, Object.fromEntries(config));
  checkPositionals(found.positionals);
  const values = definitions.map(([name, { read }]) => [name, read(found.values[name], `--${name}`)]);
  return { values: Object.fromEntries(values) as Values, positionals: found.positionals };
}

/** `parseArgs` with one-line messages for unknown arguments, and for empty ones, which it accepts. */
function parseStrictly(args: readonly string[], options: NonNullable<ParseArgsConfig['options']>) {
  const found = parse(withJoinedValues(args, options), options);
  for (const token of found.tokens) {
    if (token.kind === 'option-terminator' || token.value !== '') continue;
    const name = token.kind === 'option' ? token.rawName : 'an argument';
    throw new UsageError(name, `${name} is empty`);
  }
  return found;
}

/**
 * Makes `--up -y` one argument, `--up=-y`, for all options that have a value: parsers take an initial
 * minus for an option, and none begins like a number or an axis.
 */
function withJoinedValues(
  args: readonly string[],
  options: NonNullable<ParseArgsConfig['options']>,
): string[] {
  const joined: string[] = [];
  const end = args.includes('--') ? args.indexOf('--') : args.length;
  const takesValue = (arg = '') =>
    arg.startsWith('--') && Object.hasOwn(options, arg.slice(2)) && options[arg.slice(2)].type === 'string';
  for (const arg of args.slice(0, end)) {
    if (/^-[\d.xyz]/.test(arg) && takesValue(joined.at(-1))) joined.push(`${joined.pop()}=${arg}`);
    else joined.push(arg);
  }
  return [...joined, ...args.slice(end)];
}

function parse(args: string[], options: NonNullable<ParseArgsConfig['options']>) {
  try {
    return parseArgs({ args, options, allowPositionals: true, strict: true, tokens: true });
  } catch (error) {
    const message = (error as Error).message.replaceAll('\n', ' ').replace(/\.$/, '');
    // What follows is for files whose names begin with a minus.
    throw new UsageError('arguments', message.replace(/^(Unknown option '--[^']*')\. .*/, '$1'));
  }
}

/** `--camera` and `--up`. */
export interface CameraOptions {
  /** See `SHARED.camera`. */
  readonly camera: string;
  /** Up for a camera that is found; undefined: found, too. */
  readonly up: Vec3 | undefined;
}

/** @throws UsageError if a camera of a file is given an up. */
export function cameraOptions({
  camera,
  up,
}: {
  readonly camera: string;
  readonly up?: Vec3 | null;
}): CameraOptions {
  if (up && camera !== AUTO)
    throw new UsageError('--up', `--up is for --camera auto; ${camera} has an up of its own`);
  return { camera, up: up ?? undefined };
}

/** The settings of `--accuracy` and `--set`, and their text for people. */
export function accuracyOptions(
  preset: string | undefined,
  assignments: readonly string[],
): { readonly accuracy: AccuracySettings; readonly accuracyLabel: string } {
  const accuracy = { ...(preset && { preset }), ...settingsOf(assignments) } as Accuracy;
  return {
    accuracy: resolveAccuracy(accuracy),
    accuracyLabel: [preset ?? DEFAULT_ACCURACY, ...assignments].join(' '),
  };
}

function settingsOf(assignments: readonly string[]): Record<string, unknown> {
  const settings: Record<string, unknown> = {};
  for (const assignment of assignments) {
    const [name, value] = splitOnce(assignment, '=');
    if (value === undefined) throw wrongValue('--set', assignment, 'name=value');
    settings[name] = isNumeric(name) ? numberOf(value) : value;
  }
  return settings;
}

function isNumeric(name: string): boolean {
  if (!Object.hasOwn(ACCURACY_SETTINGS, name)) return false;
  const { values } = ACCURACY_SETTINGS[name as keyof AccuracySettings];
  return 'min' in values || typeof values[0] === 'number';
}

/** A number, or a fraction such as 1/255. Leaves other text to the setting's own check. */
function numberOf(found: string): number | string {
  const [numerator, denominator = '1'] = splitOnce(found, '/');
  const value = Number(numerator) / Number(denominator);
  return numerator.trim() !== '' && Number.isFinite(value) ? value : found;
}

function detailOf(found: string, option: string): Detail {
  const parts = found.split(',').map((part) => splitOnce(part, '='));
  const detail = ['full', 'auto'].includes(found)
    ? found
    : Object.fromEntries(parts.map(([name, value]) => [name, value?.trim() ? Number(value) : Number.NaN]));
  try {
    checkDetail(detail as Detail);
  } catch {
    const expected =
      'takes full, auto, minPsnrDb=40, maxFrameMs=8, or maxErrorPx=0.5, maxSplats=100000 and maxShare=0.5, with commas between';
    throw new UsageError(option, `${option} ${found}: ${expected}`);
  }
  return detail as Detail;
}

function splitOnce(found: string, separator: string): [string, string | undefined] {
  const at = found.indexOf(separator);
  return at < 0 ? [found, undefined] : [found.slice(0, at), found.slice(at + 1)];
}
