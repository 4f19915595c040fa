import { WebSplatterError } from '../data/errors.ts';
import type { PackedHarmonics } from '../data/packing/harmonics.ts';
import { packCloud } from '../data/packing/packed-cloud.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { readSplats } from '../io/loading/read-splats.ts';
import type { Choices } from './fuzz.ts';
import { chunked } from './ply-fixture.ts';

/** Result of reading a file: splats, or a typed error. */
export type Outcome = SplatSet<PackedHarmonics> | WebSplatterError;

/** Words that have broken readers: counts, offsets, NaN, infinity. */
const EVIL_WORDS = [
  ...[0, 1, 2, 255, 256, 65535, 65536, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff],
  ...[0x7fc00000, 0x7f800000, 0xff800000, 0x7f7fffff, 0x80000001],
];

/** The bytes with some of them changed, moved or missing. */
export function damagedBytes(bytes: Uint8Array, choices: Choices): Uint8Array<ArrayBuffer> {
  let result = Uint8Array.from(bytes);
  for (let i = choices.below(4); i >= 0; i--) {
    const at = choices.below(result.length);
    if (choices.isTrue(0.5) && at + 4 <= result.length)
      new DataView(result.buffer).setUint32(at & ~3, choices.of(EVIL_WORDS), true);
    else result[at] = choices.below(256);
  }
  if (choices.isTrue(0.2)) result = result.slice(0, choices.below(result.length + 1));
  if (choices.isTrue(0.1)) {
    const at = choices.below(result.length + 1);
    result = Uint8Array.from([...result.slice(0, at), choices.below(256), ...result.slice(at)]);
  }
  return result;
}

/** Reads a damaged file, at once or in chunks; throws unless that gives splats or a typed error. */
export async function outcomeOf(
  bytes: Uint8Array<ArrayBuffer>,
  name: string,
  chunkBytes?: number,
): Promise<Outcome> {
  const source = chunkBytes === undefined ? bytes : chunked(bytes, [chunkBytes]);
  try {
    const set = await readSplats(source, { name });
    checkDrawable(set);
    return set;
  } catch (error) {
    if (error instanceof WebSplatterError) return error;
    throw error;
  }
}

/**
 * Throws unless splats can be drawn: all values are finite, but for logits and for log scales of
 * −∞.
 */
export function checkDrawable(set: SplatSet<PackedHarmonics>): void {
  if (
    !Object.values(packCloud(set, { geometryPrecision: 'packed' }).bounds)
      .flat()
      .every(Number.isFinite)
  )
    throw new Error('bounds that are not finite');
  for (const column of [set.positions, set.rotations, set.colorDc])
    if (!column.every(Number.isFinite)) throw new Error(`not finite: ${column}`);
  if (!set.logScales.every((value) => value < Infinity)) throw new Error(`not sizes: ${set.logScales}`);
  if (set.opacityLogits.some(Number.isNaN)) throw new Error('an opacity that is no number');
}
