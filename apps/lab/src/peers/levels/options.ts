import { resolve } from 'node:path';
import { parseArgs } from 'node:util';
import { BenchError } from '../runner/bench-error.ts';
import { EVIDENCE_USAGE, FLAG, parsed, pathFrom, TEXT, wholeNumber } from '../runner/options.ts';

export const USAGE = `--scene FILE | --synthetic N [OPTION…]
  --scene FILE        splats in any format that is read; cameras are found as by bench:peers
  --synthetic N       a scene made by code, of that many splats
  --shares P,…        percent of the splats that are drawn at most; default 50,25,12,6
  --views N           the first so many cameras; default 4
  --flat              gives all the scene without harmonics above the base colour
${EVIDENCE_USAGE}`;

export type LevelsOptions = ReturnType<typeof readOptions>;

/**
 * Reads the command line; paths are from `folder`.
 *
 * @throws BenchError naming the option.
 */
export function readOptions(args: readonly string[], folder: string) {
  const { scene, synthetic, shares, views, flat, evidence } = parse(args);
  if ((scene === undefined) === (synthetic === undefined))
    throw new BenchError('Give --scene or --synthetic.');
  return {
    /** One path or one number, as `sceneFiles` takes them. */
    scenes: scene === undefined ? [] : [resolve(folder, scene)],
    synthetic: synthetic === undefined ? [] : [wholeNumber('synthetic', synthetic)],
    /** 0…1. */
    shares: shares.split(',').map((percent) => wholeNumber('shares', percent) / 100),
    views: wholeNumber('views', views),
    isFlat: flat,
    evidenceFile: pathFrom(folder, evidence),
  };
}

function parse(args: readonly string[]) {
  const options = {
    ...{ scene: TEXT, synthetic: TEXT, evidence: TEXT, flat: FLAG },
    shares: { ...TEXT, default: '50,25,12,6' },
    views: { ...TEXT, default: '4' },
  } as const;
  return parsed(() => parseArgs({ args: [...args], options }).values);
}
