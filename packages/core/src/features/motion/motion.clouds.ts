import type { CloudFeature } from '../../clouds/cloud-feature.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import type { EffectUse } from '../../gpu/effects/effect.ts';
import { motion } from './motion.gpu.ts';
import { type PackedMotion, timeIntervalOf } from './pack-motion.data.ts';
import type { TimeRange } from './splat-motion.data.ts';

const { REACH_WORDS, TIME_INTERVALS } = SHADER_CONSTANTS;
const { minPosition, maxPosition, count: WORDS } = CHUNK_WORDS;

/** The CPU's part of a cloud's motion: the effect that draws it, and where its chunks are at a time. */
export class CloudMotion implements CloudFeature {
  readonly name = 'motion';
  readonly lacksLevels = 'its splats move, and levels of detail are made of splats that stand still.';
  readonly range: TimeRange;
  readonly #reaches: Float32Array;
  /** Chunks by interval of time, of the cloud's chunks `#of`. */
  readonly #moved = new Map<number, ArrayBuffer>();
  #of: ArrayBuffer | null = null;

  constructor({ range, reaches }: PackedMotion) {
    this.range = range;
    this.#reaches = reaches;
  }

  /** Shows the cloud at a time; default the first. Outside of the range, its first or last. */
  effectAt(time = this.range[0]): EffectUse {
    return motion({ time, range: this.range });
  }

  /**
   * Returns the chunks that hold any splat that can be seen at `time`, as `Chunk` structs with bounds of
   * all places that their splats have in that interval of time. The same buffer for equal intervals,
   * until `chunks` is another.
   *
   * @param chunks the cloud's, with bounds of its splats as trained.
   */
  chunksAt(chunks: ArrayBuffer, time = this.range[0]): ArrayBuffer {
    if (this.#of !== chunks) this.#moved.clear();
    this.#of = chunks;
    const interval = timeIntervalOf(this.range, time);
    let moved = this.#moved.get(interval);
    if (!moved) {
      moved = this.#chunksIn(new Float32Array(chunks), interval);
      this.#moved.set(interval, moved);
    }
    return moved;
  }

  #chunksIn(chunks: Float32Array, interval: number): ArrayBuffer {
    const moved = new Float32Array(chunks.length);
    let end = 0;
    for (let at = 0; at < chunks.length; at += WORDS) {
      const reach = ((at / WORDS) * TIME_INTERVALS + interval) * REACH_WORDS;
      if (this.#reaches[reach] > this.#reaches[reach + 3]) continue;
      moved.set(chunks.subarray(at, at + WORDS), end);
      for (let axis = 0; axis < 3; axis++) {
        moved[end + minPosition + axis] += this.#reaches[reach + axis];
        moved[end + maxPosition + axis] += this.#reaches[reach + 3 + axis];
      }
      end += WORDS;
    }
    return moved.slice(0, end).buffer;
  }
}
