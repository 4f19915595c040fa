import { resolve } from 'node:path';
import type { parseArgs } from 'node:util';
import { BenchError } from './bench-error.ts';

/** Options of every bench of pages. */
export interface CommonOptions {
  /** Names, separated by commas. */
  readonly peers: string;
  readonly installs: boolean;
  readonly packFolder: string | null;
  readonly camerasFile: string | null;
  readonly size: SizePx;
  readonly pictureSize: SizePx;
  readonly rounds: number;
  readonly frames: number;
  readonly warmUpFrames: number;
  readonly takesPictures: boolean;
  readonly timeLimitMs: number;
  /** Infinity without a limit. */
  readonly budgetMs: number;
  readonly isSoftware: boolean;
  readonly outFolder: string | null;
  readonly jsonFile: string | null;
  readonly evidenceFile: string | null;
}

export interface SizePx {
  readonly widthPx: number;
  readonly heightPx: number;
}

/** Lines of the usage that all benches share. */
export const EVIDENCE_USAGE = `  --evidence FILE     writes the tables as evidence for the documentation: evidence/NAME.json, to be given a title and a
                      conclusion`;

/** Lines of the usage that benches of pages share. */
export const RUN_USAGE = `  --time-limit S      seconds that a peer may take in one round; default 300
  --budget S          seconds that all peers may take; what is not done then is left out of the table
  --software          draws on the CPU by SwiftShader
  --out FOLDER        keeps the pictures there
  --json FILE         writes everything that was measured
${EVIDENCE_USAGE}
  --no-install        leaves out peers whose packages are not installed, instead of installing them`;

export const TEXT = { type: 'string' } as const;
export const FLAG = { type: 'boolean', default: false } as const;

/** Options of every bench of pages for `parseArgs`, with the defaults in which benches differ. */
export function commonArguments(defaults: { readonly pictureSize: string; readonly rounds: string }) {
  return {
    ...{ cameras: TEXT, budget: TEXT, out: TEXT, json: TEXT, evidence: TEXT, pack: TEXT },
    ...{ 'no-pictures': FLAG, software: FLAG, 'no-install': FLAG },
    peers: { ...TEXT, default: 'all' },
    size: { ...TEXT, default: '1920x1080' },
    'picture-size': { ...TEXT, default: defaults.pictureSize },
    rounds: { ...TEXT, default: defaults.rounds },
    frames: { ...TEXT, default: '120' },
    'warm-up': { ...TEXT, default: '20' },
    'time-limit': { ...TEXT, default: '300' },
  } as const;
}

type CommonValues = ReturnType<
  typeof parseArgs<{ readonly options: ReturnType<typeof commonArguments> }>
>['values'];

/** Converts the options of every bench of pages; paths are from `folder`. @throws BenchError naming the option. */
export function commonOptions(values: CommonValues, folder: string): CommonOptions {
  return {
    peers: values.peers,
    installs: !values['no-install'],
    packFolder: pathFrom(folder, values.pack),
    camerasFile: pathFrom(folder, values.cameras),
    size: size('size', values.size),
    pictureSize: size('picture-size', values['picture-size']),
    rounds: wholeNumber('rounds', values.rounds),
    frames: wholeNumber('frames', values.frames),
    warmUpFrames: wholeNumber('warm-up', values['warm-up']),
    takesPictures: !values['no-pictures'],
    timeLimitMs: 1000 * wholeNumber('time-limit', values['time-limit']),
    budgetMs: values.budget === undefined ? Infinity : 1000 * wholeNumber('budget', values.budget),
    isSoftware: values.software,
    outFolder: pathFrom(folder, values.out),
    jsonFile: pathFrom(folder, values.json),
    evidenceFile: pathFrom(folder, values.evidence),
  };
}

/** The result of `parse`. @throws BenchError with the message of any error. */
export function parsed<Values>(parse: () => Values): Values {
  try {
    return parse();
  } catch (error) {
    throw new BenchError((error as Error).message);
  }
}

/** The path of a file that an option names; null if it names none. */
export function pathFrom(folder: string, file: string | undefined): string | null {
  return file === undefined ? null : resolve(folder, file);
}

/** @throws BenchError naming the option. */
export function wholeNumber(option: string, text: string): number {
  const number = Number(text);
  if (Number.isInteger(number) && number >= 1) return number;
  throw new BenchError(`--${option} has "${text}"; it takes whole numbers from 1 on.`);
}

function size(option: string, text: string): SizePx {
  const [, width, height] = /^([1-9]\d*)x([1-9]\d*)$/.exec(text) ?? [];
  if (!height) throw new BenchError(`--${option} has "${text}"; it takes pixels as WIDTHxHEIGHT.`);
  return { widthPx: Number(width), heightPx: Number(height) };
}
