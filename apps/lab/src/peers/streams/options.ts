import { parseArgs } from 'node:util';
import { BenchError } from '../runner/bench-error.ts';
import {
  type CommonOptions,
  commonArguments,
  commonOptions,
  parsed,
  pathFrom,
  RUN_USAGE,
  TEXT,
  wholeNumber,
} from '../runner/options.ts';
import { STREAM_PEER_NAMES, type StreamFiles } from './stream-peers.ts';

export const USAGE = `--bricks FILE --sog FILE --rad FILE [OPTION…]
  --bricks FILE       a scene, written by websplatter convert
  --sog FILE          the same scene, the lod-meta.json written by splat-transform
  --rad FILE          the same scene, written by Spark's build-lod
  --scene FILE        the splats that all were made of, in any format that is read: pictures are held against float64 too
  --cameras FILE      a list as for bench:peers, if not beside --scene: the first is seen at the start, then turned about
                      its target; pictures are taken by all
  --peers NAME,…      ${STREAM_PEER_NAMES.join(', ')}; default all whose files are given;
                      NAME?OPTIONS for an adapter's options, such as playcanvas?lodUnderfillLimit=10
  --max-splats N      splats that are drawn at most; default 1000000
  --pool-mb N         MiB of splats held on the GPU at most, where there is such a limit; default 512
  --rate-mbit N       of the line, in all requests together; default without limit
  --latency N         ms from a request to the first byte of its answer; default 0
  --size WxH          pixels; default 1920x1080
  --picture-size WxH  pixels of the pictures; default 960x540
  --rounds N          rounds, in each of which every peer has a fresh browser; default 3
  --frames N          frames of a turn; default 120
  --warm-up N         frames before it; default 20
  --no-pictures       takes no pictures
${RUN_USAGE}
  --pack FOLDER       measures nothing, but writes a bench there that needs only Node and a Chromium
  --help              prints this`;

export interface StreamsOptions extends CommonOptions {
  readonly files: StreamFiles;
  readonly sceneFile: string | null;
  readonly maxSplats: number;
  readonly poolBytes: number;
  /** Infinity without a limit. */
  readonly bitsPerSecond: number;
  readonly latencyMs: number;
}

/**
 * Reads the command line; paths are from `folder`.
 *
 * @throws BenchError naming the option.
 */
export function readOptions(args: readonly string[], folder: string): StreamsOptions {
  const values = parse(args);
  const given = (['bricks', 'sog', 'rad'] as const).flatMap((format) => {
    const file = pathFrom(folder, values[format]);
    return file ? [[format, file]] : [];
  });
  if (!values.pack && given.length === 0)
    throw new BenchError('No scene: give --bricks, --sog and --rad, or some of them.');
  if (!values.pack && !values.scene && !values.cameras) throw new BenchError('Give --cameras or --scene.');
  const rate = values['rate-mbit'];
  return {
    ...commonOptions(values, folder),
    files: Object.fromEntries(given),
    sceneFile: pathFrom(folder, values.scene),
    maxSplats: wholeNumber('max-splats', values['max-splats']),
    poolBytes: wholeNumber('pool-mb', values['pool-mb']) * 2 ** 20,
    bitsPerSecond: rate === undefined ? Infinity : 1e6 * wholeNumber('rate-mbit', rate),
    latencyMs: values.latency === undefined ? 0 : wholeNumber('latency', values.latency),
  };
}

function parse(args: readonly string[]) {
  const options = {
    ...commonArguments({ pictureSize: '960x540', rounds: '3' }),
    ...{ bricks: TEXT, sog: TEXT, rad: TEXT, scene: TEXT, 'rate-mbit': TEXT, latency: TEXT },
    'max-splats': { ...TEXT, default: '1000000' },
    'pool-mb': { ...TEXT, default: '512' },
  } as const;
  return parsed(() => parseArgs({ args: [...args], options }).values);
}
