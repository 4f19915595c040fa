import { resolve } from 'node:path';
import { parseArgs } from 'node:util';
import type { CommonOptions, SizePx } from './bench-definition.ts';
import { BenchError } from './bench-error.ts';
import { PEER_NAMES, sourcesFolder } from './peer-list.ts';

/** Behind the command's name. */
export const USAGE = `--scenes FILE,… | --synthetic N,… [OPTION…]
  --scenes FILE,…     files of any format that is read, or folders of them; NAME.cameras.json has the cameras of NAME.ply,
                      NAME.spz and so on, unless NAME.spz.cameras.json has them
  --synthetic N,…     scenes made by code, of that many splats
  --cameras FILE      cameras for all scenes instead: a list of { name, position, target, up, fovYDegrees, near, far };
                      the first is turned about its target for the times, the pictures are taken by all
  --peers NAME,…      ${PEER_NAMES.slice(0, 5).join(', ')},
                      ${PEER_NAMES.slice(5).join(', ')}; default all;
                      NAME=ADAPTER for one's own, NAME?OPTIONS for an adapter's options
  --size WxH          pixels; default 1920x1080
  --picture-size WxH  pixels of the pictures that are held against float64; default 480x270
  --rounds N          rounds, in each of which every peer has a fresh browser; default 2
  --frames N          frames of a turn; default 120
  --warm-up N         frames before it; default 20
  --jumps N           frames after jumps; default 16
  --from-file         gives pages the file, as if it had been dropped there, instead of its address
  --loads             measures loads alone, without a turn or jumps
  --no-pictures       takes no pictures: float64 needs minutes for millions of splats
  --time-limit S      seconds that a peer may take in one round; default 300
  --budget S          seconds that all peers may take; what is not done then is left out of the table
  --software          draws on the CPU by SwiftShader
  --out FOLDER        keeps the pictures there
  --json FILE         writes everything that was measured
  --no-install        leaves out peers whose packages are not installed, instead of installing them
  --pack FOLDER       measures nothing, but writes a bench of the peers there that needs only Node and a Chromium
  --sources FOLDER    has clones of peers that are no packages, by their names; default apps/lab/peers/sources
  --help              prints this`;

export interface BenchOptions extends CommonOptions {
  /** Paths. */
  readonly scenes: readonly string[];
  /** Numbers of splats. */
  readonly synthetic: readonly number[];
  readonly jumps: number;
  readonly isFromFile: boolean;
  /** Loads alone. */
  readonly isLoads: boolean;
  /** Of the clones of peers that are no packages. */
  readonly sourcesFolder: string;
}

/**
 * Reads the command line; paths are from `folder`.
 *
 * @throws BenchError naming the option.
 */
export function readOptions(args: readonly string[], folder: string): BenchOptions {
  const values = parse(args);
  const scenes = values.scenes?.split(',').map((file) => resolve(folder, file)) ?? [];
  const synthetic = values.synthetic?.split(',').map((text) => wholeNumber('synthetic', text)) ?? [];
  if (scenes.length + synthetic.length === 0 && !values.pack)
    throw new BenchError('No scene: give --scenes or --synthetic.');
  return {
    ...commonOptions(values, folder),
    scenes,
    synthetic,
    jumps: wholeNumber('jumps', values.jumps),
    isFromFile: values['from-file'],
    isLoads: values.loads,
    sourcesFolder: values.sources === undefined ? sourcesFolder : resolve(folder, values.sources),
  };
}

function parse(args: readonly string[]) {
  const options = {
    ...commonArguments({ pictureSize: '480x270', rounds: '2' }),
    ...{ scenes: TEXT, synthetic: TEXT, 'from-file': FLAG, loads: FLAG, sources: TEXT },
    jumps: { ...TEXT, default: '16' },
  } as const;
  return parsed(() => parseArgs({ args: [...args], options }).values);
}

export const TEXT = { type: 'string' } as const;
const FLAG = { type: 'boolean', default: false } as const;

/** What every bench takes, for `parseArgs`, with the defaults in which they differ. */
export function commonArguments(defaults: { readonly pictureSize: string; readonly rounds: string }) {
  return {
    ...{ cameras: TEXT, budget: TEXT, out: TEXT, json: TEXT, pack: TEXT },
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

/** Reads what every bench takes; paths are from `folder`. @throws BenchError naming the option. */
export function commonOptions(values: CommonValues, folder: string): CommonOptions {
  const path = (file: string | undefined) => (file === undefined ? null : resolve(folder, file));
  return {
    peers: values.peers,
    installs: !values['no-install'],
    packFolder: path(values.pack),
    camerasFile: path(values.cameras),
    size: size('size', values.size),
    pictureSize: size('picture-size', values['picture-size']),
    rounds: wholeNumber('rounds', values.rounds),
    frames: wholeNumber('frames', values.frames),
    warmUpFrames: wholeNumber('warm-up', values['warm-up']),
    takesPictures: !values['no-pictures'],
    timeLimitMs: 1000 * wholeNumber('time-limit', values['time-limit']),
    budgetMs: values.budget === undefined ? Infinity : 1000 * wholeNumber('budget', values.budget),
    isSoftware: values.software,
    outFolder: path(values.out),
    jsonFile: path(values.json),
  };
}

/** What `parse` returns. @throws BenchError with what it throws. */
export function parsed<Values>(parse: () => Values): Values {
  try {
    return parse();
  } catch (error) {
    throw new BenchError((error as Error).message);
  }
}

/** @throws BenchError naming the option. */
export function wholeNumber(option: string, text: string): number {
  const number = Number(text);
  if (Number.isInteger(number) && number >= 1) return number;
  throw new BenchError(`--${option} has "${text}"; it takes whole numbers from 1 on.`);
}

/** @throws BenchError naming the option. */
function size(option: string, text: string): SizePx {
  const [, width, height] = /^([1-9]\d*)x([1-9]\d*)$/.exec(text) ?? [];
  if (!height) throw new BenchError(`--${option} has "${text}"; it takes pixels as WIDTHxHEIGHT.`);
  return { widthPx: Number(width), heightPx: Number(height) };
}
