import { resolve } from 'node:path';
import { parseArgs } from 'node:util';
import { BenchError } from '../runner/bench-error.ts';
import {
  type CommonOptions,
  commonArguments,
  commonOptions,
  FLAG,
  parsed,
  RUN_USAGE,
  TEXT,
  wholeNumber,
} from '../runner/options.ts';
import { PEER_NAMES, sourcesFolder } from '../runner/peer-list.ts';

export const USAGE = `--scenes FILE,… | --synthetic N,… [OPTION…]
  --scenes FILE,…     files of any format that is read, or folders of them; NAME.cameras.json has the cameras of NAME.ply,
                      NAME.spz and so on, unless NAME.spz.cameras.json has them
  --synthetic N,…     scenes made by code, of that many splats
  --cameras FILE      cameras for all scenes instead: a list of { name, position, target, up, fovYDegrees, near, far };
                      the first is turned about its target for the times, the pictures are taken by all
  --peers NAME,…      ${PEER_NAMES.slice(0, 6).join(', ')},
                      ${PEER_NAMES.slice(6).join(', ')}; default all;
                      NAME=ADAPTER for one's own, NAME?OPTIONS for an adapter's options
  --size WxH          pixels; default 1920x1080
  --picture-size WxH  pixels of the pictures that are held against float64; default 480x270
  --rounds N          rounds, in each of which every peer has a fresh browser; default 2
  --frames N          frames of a turn; default 120
  --warm-up N         frames before it; default 20
  --jumps N           frames after jumps; default 16
  --from-file         gives pages the file, as if it had been dropped there, instead of its address
  --loads             measures loads alone, without a turn or jumps
  --passes            measures the GPU time of whole frames and of each of their passes, too
  --no-pictures       takes no pictures: float64 needs minutes for millions of splats
${RUN_USAGE}
  --pack FOLDER       measures nothing, but writes a bench of the peers there that needs only Node and a Chromium
  --sources FOLDER    has clones of peers that are no packages, by their names; default apps/lab/peers/sources
  --help              prints this`;

export interface FramesOptions extends CommonOptions {
  /** Paths. */
  readonly scenes: readonly string[];
  /** Numbers of splats. */
  readonly synthetic: readonly number[];
  readonly jumps: number;
  readonly isFromFile: boolean;
  /** Whether loads alone are measured. */
  readonly isLoads: boolean;
  /** Whether the GPU's time is measured by frame and pass, too. */
  readonly isByPass: boolean;
  /** Folder with clones of peers that are no packages. */
  readonly sourcesFolder: string;
}

/**
 * Reads the command line; paths are from `folder`.
 *
 * @throws BenchError naming the option.
 */
export function readOptions(args: readonly string[], folder: string): FramesOptions {
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
    isByPass: values.passes,
    sourcesFolder: values.sources === undefined ? sourcesFolder : resolve(folder, values.sources),
  };
}

function parse(args: readonly string[]) {
  const options = {
    ...commonArguments({ pictureSize: '480x270', rounds: '2' }),
    ...{ scenes: TEXT, synthetic: TEXT, 'from-file': FLAG, loads: FLAG, passes: FLAG, sources: TEXT },
    jumps: { ...TEXT, default: '16' },
  } as const;
  return parsed(() => parseArgs({ args: [...args], options }).values);
}
