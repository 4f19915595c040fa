import { resolve } from 'node:path';
import { parseArgs } from 'node:util';
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

export interface SizePx {
  readonly widthPx: number;
  readonly heightPx: number;
}

export interface BenchOptions {
  /** Paths. */
  readonly scenes: readonly string[];
  /** Numbers of splats. */
  readonly synthetic: readonly number[];
  readonly camerasFile: string | null;
  /** Names, separated by commas. */
  readonly peers: string;
  readonly size: SizePx;
  readonly pictureSize: SizePx;
  readonly rounds: number;
  readonly frames: number;
  readonly warmUpFrames: number;
  readonly jumps: number;
  readonly isFromFile: boolean;
  /** Loads alone. */
  readonly isLoads: boolean;
  readonly takesPictures: boolean;
  readonly timeLimitMs: number;
  /** Infinity without a limit. */
  readonly budgetMs: number;
  readonly isSoftware: boolean;
  readonly outFolder: string | null;
  readonly jsonFile: string | null;
  readonly installs: boolean;
  readonly packFolder: string | null;
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
  const path = (file: string | undefined) => (file === undefined ? null : resolve(folder, file));
  const scenes = values.scenes?.split(',').map((file) => resolve(folder, file)) ?? [];
  const synthetic = values.synthetic?.split(',').map((text) => wholeNumber('synthetic', text)) ?? [];
  const packFolder = path(values.pack);
  if (scenes.length + synthetic.length === 0 && !packFolder)
    throw new BenchError('No scene: give --scenes or --synthetic.');
  return {
    scenes,
    synthetic,
    camerasFile: path(values.cameras),
    peers: values.peers,
    size: size('size', values.size),
    pictureSize: size('picture-size', values['picture-size']),
    rounds: wholeNumber('rounds', values.rounds),
    frames: wholeNumber('frames', values.frames),
    warmUpFrames: wholeNumber('warm-up', values['warm-up']),
    jumps: wholeNumber('jumps', values.jumps),
    isFromFile: values['from-file'],
    isLoads: values.loads,
    takesPictures: !values['no-pictures'],
    timeLimitMs: 1000 * wholeNumber('time-limit', values['time-limit']),
    budgetMs: values.budget === undefined ? Infinity : 1000 * wholeNumber('budget', values.budget),
    isSoftware: values.software,
    outFolder: path(values.out),
    jsonFile: path(values.json),
    installs: !values['no-install'],
    packFolder,
    sourcesFolder: path(values.sources) ?? sourcesFolder,
  };
}

function parse(args: readonly string[]) {
  try {
    return parseArgs({
      args: [...args],
      options: {
        scenes: { type: 'string' },
        synthetic: { type: 'string' },
        cameras: { type: 'string' },
        peers: { type: 'string', default: 'all' },
        size: { type: 'string', default: '1920x1080' },
        'picture-size': { type: 'string', default: '480x270' },
        rounds: { type: 'string', default: '2' },
        frames: { type: 'string', default: '120' },
        'warm-up': { type: 'string', default: '20' },
        jumps: { type: 'string', default: '16' },
        'from-file': { type: 'boolean', default: false },
        loads: { type: 'boolean', default: false },
        'no-pictures': { type: 'boolean', default: false },
        'time-limit': { type: 'string', default: '300' },
        budget: { type: 'string' },
        software: { type: 'boolean', default: false },
        out: { type: 'string' },
        json: { type: 'string' },
        'no-install': { type: 'boolean', default: false },
        pack: { type: 'string' },
        sources: { type: 'string' },
      },
    }).values;
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

function size(option: string, text: string): SizePx {
  const [, width, height] = /^([1-9]\d*)x([1-9]\d*)$/.exec(text) ?? [];
  if (!height) throw new BenchError(`--${option} has "${text}"; it takes pixels as WIDTHxHEIGHT.`);
  return { widthPx: Number(width), heightPx: Number(height) };
}
