import { checkMatrix } from '../data/camera/camera.ts';
import { given } from '../data/given.ts';
import { identity4 } from '../data/math/mat4.ts';
import { GEOMETRY_WORDS, packGeometry } from '../data/packing/geometry.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import { permuteSplats } from '../data/packing/morton-order.ts';
import { givenSet } from '../data/splats/check-set.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { frameSample } from './frame-sample.ts';
import {
  checkFramingOptions,
  type FramedCloud,
  type FramingOptions,
  framingWishes,
} from './framing-wishes.ts';
import type { SampledSplats } from './samples.ts';
import { MOST_SAMPLES, pickWords, shareSamples } from './samples.ts';
import type { SceneFraming } from './scene-framing.ts';
import { decodeSamples } from './splat-decoder.ts';

const STRIDE = GEOMETRY_WORDS.f32;

/** The kept splats of one set. */
interface KeptCloud extends FramedCloud {
  readonly origin: SampledSplats['origin'];
  /** Index of the first kept splat among all added ones, a multiple of the step. */
  readonly first: number;
  readonly words: Uint32Array<ArrayBuffer>;
}

/**
 * Finds a first camera for splats in memory, or read in pieces. The counterpart of `frameScene` for
 * tools without a GPU. Keeps at most 8 MB of splats.
 *
 * @example
 * const framer = new SplatFramer();
 * await readSplatPieces(file, {}, async (piece) => framer.add(piece));
 * const up = framer.frame()?.up;
 */
export class SplatFramer {
  #parts: KeptCloud[] = [];
  /** Added splats. */
  #count = 0;
  /** Sampling stride: every `#step`-th splat is kept. */
  #step = 1;

  /**
   * Adds splats. They are copied, so the set may change afterwards.
   *
   * @param modelMatrix set to world, column-major. Default: identity.
   * @throws InvalidArgumentError 'set' or 'modelMatrix' if it is invalid.
   */
  add(set: SplatSet<Harmonics>, modelMatrix: ArrayLike<number> = identity4()): void {
    givenSet(set);
    checkMatrix('modelMatrix', modelMatrix, 'splats');
    const offset = -this.#count & (this.#step - 1);
    const rows = new Uint32Array(Math.max(0, Math.ceil((set.count - offset) / this.#step)));
    for (let i = 0; i < rows.length; i++) rows[i] = offset + i * this.#step;
    const bare = { ...set, harmonics: { degree: 0, coefficients: new Float32Array(0) } } as const;
    const words = new Uint32Array(packGeometry(permuteSplats(bare, rows), 'f32').words);
    const { origin, fileFacts } = set;
    const matrix = Float64Array.from(modelMatrix);
    this.#parts.push({
      facts: { fileFacts: fileFacts ?? null },
      matrix,
      origin,
      first: this.#count + offset,
      words,
    });
    this.#count += set.count;
    while (this.#kept > 2 * MOST_SAMPLES) this.#halve();
  }

  /**
   * Returns the camera; null if no splat is visible. The same splats in the same order give the
   * same result on every machine.
   *
   * @throws InvalidArgumentError naming the option.
   */
  frame(options: FramingOptions = {}): SceneFraming | null {
    checkFramingOptions(given(options));
    if (this.#count === 0) return null;
    const counts = this.#parts.map(({ words }) => ({ splats: words.length / STRIDE, instances: 1 }));
    const { chosen } = shareSamples(counts, MOST_SAMPLES);
    const samples = this.#parts.map(({ words, origin, matrix }, i): SampledSplats => {
      const { splats, instances } = chosen[i];
      return {
        precision: 'f32',
        words: pickWords(words, STRIDE, splats),
        logScales: new Float32Array(2 * splats.length),
        instances,
        origin,
        matrices: Float64Array.from(matrix),
        opacities: Float64Array.of(1),
      };
    });
    const weight = Math.max(1, this.#count / MOST_SAMPLES);
    return frameSample(decodeSamples(samples, weight), framingWishes(this.#parts, options));
  }

  get #kept(): number {
    return this.#parts.reduce((sum, { words }) => sum + words.length / STRIDE, 0);
  }

  #halve(): void {
    const step = this.#step;
    this.#step = 2 * step;
    this.#parts = this.#parts.map((part) => {
      const offset = part.first % this.#step === 0 ? 0 : 1;
      const kept = new Uint32Array(Math.max(0, Math.ceil((part.words.length / STRIDE - offset) / 2)));
      for (let i = 0; i < kept.length; i++) kept[i] = offset + 2 * i;
      return { ...part, first: part.first + offset * step, words: pickWords(part.words, STRIDE, kept) };
    });
  }
}
