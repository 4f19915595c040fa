import { mergeSplats } from '../../data/editing/merge-splats.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { given, wrongArgument } from '../../data/given.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { checkPrecision } from '../../data/packing/check-precision.ts';
import { chunksOf, logScalesOf, setLogScales } from '../../data/packing/chunks.ts';
import { cloudFacts } from '../../data/packing/cloud-facts.ts';
import { dropNonFinite } from '../../data/packing/drop-non-finite.ts';
import { packGeometry } from '../../data/packing/geometry.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import { logScaleRange } from '../../data/packing/log-scale.ts';
import { mortonOrder, permuteSplats } from '../../data/packing/morton-order.ts';
import {
  type PackedCloud,
  packedHarmonics,
  sampledBounds,
  totalBounds,
} from '../../data/packing/packed-cloud.ts';
import { type CloudPrecision, ownShPrecision } from '../../data/packing/precision.ts';
import { givenSet } from '../../data/splats/check-set.ts';
import { checkStill } from '../../data/splats/columns.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';

/** One of a morph's two states: packed splats, in the same order of storage as the other state. */
export type MorphState = Pick<PackedCloud, 'geometry' | 'harmonics'>;

/**
 * Two sets of splats, and how far a cloud is between them: see `followMorph`. Outlives clouds,
 * engines and devices.
 *
 * @example
 * const calm = await readSplats('/calm.ply');
 * const smiling = await readSplats('/smiling.ply');
 * const morph = new SplatMorph(calm, smiling, engine.accuracy);
 * const face = engine.addPacked(morph.packed);
 * await followMorph(face, morph);
 * morph.amount = 0.5;
 * view.render({ camera, clouds: [{ cloud: face }], widthPx, heightPx });
 */
export class SplatMorph {
  /**
   * The first set, packed with bounds that hold both: add this to engines. Splats are stored in the
   * order of the first set, and rows are numbered from 0.
   */
  readonly packed: PackedCloud;
  /** The second set, in the same order. */
  readonly second: MorphState;
  #amount = 0;

  /**
   * Packs two sets, on the calling thread. Row i of one becomes row i of the other; bands of
   * harmonics that one of them lacks are 0.
   *
   * @param precision as an engine's `accuracy` has it. A palette becomes u8.
   * @throws InvalidArgumentError if they differ in their numbers of splats, or if a splat is not
   *   finite.
   */
  constructor(from: SplatSet<Harmonics>, to: SplatSet<Harmonics>, precision: CloudPrecision) {
    const { geometryPrecision, shPrecision } = given(precision, {}, 'precision');
    checkPrecision({ geometryPrecision, shPrecision });
    const { count } = checkFinite('from', from);
    checkFinite('to', to);
    if (to.count !== count) {
      const message = `from has ${count} splats and to has ${to.count}; each splat of one becomes one of the other, so they must have as many.`;
      throw new InvalidArgumentError('to', message);
    }
    const both = mergeSplats([from, to]);
    const facts = cloudFacts(both);
    const harmonics = packedHarmonics(both, facts, ownShPrecision(shPrecision));
    const order = mortonOrder(both.positions, count);
    const [first, second] = [0, count].map((start) =>
      permuteSplats(
        { ...both, harmonics },
        order.map((row) => start + row),
      ),
    );
    const chunks = unionOf(chunksOf(first), chunksOf(second));
    const bounds = totalBounds(chunks.buffer, both.origin);
    const stateOf = (set: typeof first): MorphState => ({
      geometry: packGeometry(set, geometryPrecision, chunks),
      harmonics: set.harmonics,
    });
    this.packed = {
      ...stateOf(first),
      count,
      origin: both.origin,
      bounds,
      robustBounds: count > 0 ? sampledBounds(both) : bounds,
      chunks: chunks.buffer,
      fileIndices: first.fileIndices,
      dropped: both.dropped,
      facts,
    };
    this.second = stateOf(second);
  }

  /**
   * How far the splats are from the first set, 0, to the second, 1; clamped to that. Default 0.
   * Clouds show it from their next frame on.
   *
   * @throws InvalidArgumentError unless it is a number.
   */
  get amount(): number {
    return this.#amount;
  }

  set amount(amount: number) {
    if (typeof amount !== 'number' || Number.isNaN(amount))
      throw wrongArgument('amount', amount, 'a number from 0 to 1');
    this.#amount = Math.max(0, Math.min(1, amount));
  }
}

function checkFinite(argument: string, set: SplatSet<Harmonics>): SplatSet<Harmonics> {
  const lost = givenSet(set, argument).count - dropNonFinite(set).count;
  checkStill(set, 'a morph');
  if (lost === 0) return set;
  const message = `${argument} has ${lost} splats with values that are not finite; leave out the same rows of both sets.`;
  throw new InvalidArgumentError(argument, message);
}

/** Chunks that hold the centres and log scales of two states, and so of all between them. */
function unionOf(a: Float32Array<ArrayBuffer>, b: Float32Array<ArrayBuffer>): Float32Array<ArrayBuffer> {
  const { minPosition, maxPosition, count: stride } = CHUNK_WORDS;
  const chunks = a.slice();
  for (let at = 0; at < chunks.length; at += stride) {
    for (let axis = 0; axis < 3; axis++) {
      const low = at + minPosition + axis;
      const high = at + maxPosition + axis;
      chunks[low] = Math.min(a[low], b[low]);
      chunks[high] = Math.max(a[high], b[high]);
    }
    const ranges = [a, b].map((each) => logScalesOf(each, at / stride));
    const smallest = Math.min(...ranges.map(({ min }) => min));
    const largest = Math.max(...ranges.map(({ min, step }) => min + 65535 * step));
    setLogScales(chunks, at / stride, logScaleRange(smallest, largest));
  }
  return chunks;
}
