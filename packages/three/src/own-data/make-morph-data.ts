import {
  checkAccuracy,
  DEFAULT_ACCURACY,
  GEOMETRY_WORDS,
  resolveAccuracy,
  type SplatCloud,
} from '@websplatter/core';
import { flushEdits, followMorph, SplatMorph } from '@websplatter/core/own-data';
import { type Box3, Vector3 } from 'three/webgpu';
import type { DataEdits } from '../cloud/data-edits.ts';
import { ChangeAnnouncer, tellObjects } from '../cloud/shown-data.ts';
import { SplatData } from '../cloud/splat-data.ts';
import { type MakeSplatDataOptions, type SplatDataInput, setOf } from './make-splat-data.ts';

/**
 * Makes data that go from one cloud of splats, at the `amount` 0, to another, at 1, for
 * `<Splats src={morph}>` or a SplatCloudObject. Row i of one becomes row i of the other: positions,
 * opacities and colours change linearly, sizes geometrically, rotations along the shorter arc.
 *
 * Packs on the calling thread. Both clouds stay in memory, for other renderers and for the renderer
 * after a lost device; each renderer needs the GPU memory of three such clouds.
 *
 * @throws InvalidArgumentError if the clouds differ in their numbers of splats, or if a splat is not
 *   finite; and as `makeSplatData` does.
 * @example
 * const colors = [1, 0, 0, 0, 0, 1];
 * const scales = [0.1, 0.1, 0.1, 0.1, 0.1, 0.1];
 * const apart = { positions: [-1, 0, 0, 1, 0, 0], scales, colors };
 * const together = { positions: [0, 0, 0, 0.1, 0, 0], scales, colors };
 * const morph = makeMorphData(apart, together);
 * scene.add(new SplatCloudObject(morph));
 * morph.amount = 0.5;
 */
export function makeMorphData(
  from: SplatDataInput,
  to: SplatDataInput,
  { name = 'morph', accuracy = DEFAULT_ACCURACY }: MakeSplatDataOptions = {},
): MorphData {
  const precision = checkAccuracy(accuracy) ?? resolveAccuracy();
  return new MorphData(new SplatMorph(setOf(from), setOf(to), precision), name);
}

/**
 * Data between two clouds of splats, made by `makeMorphData`. `bounds` hold both. They are drawn in
 * full detail, and `editsOf` refuses them.
 */
export class MorphData extends SplatData {
  readonly #morph: SplatMorph;
  readonly #following: FollowedMorph;

  /** @internal Use `makeMorphData`. */
  constructor(morph: SplatMorph, name: string) {
    super(morph.packed, name);
    this.#morph = morph;
    this.#following = new FollowedMorph(this, morph);
    this.edits = this.#following;
  }

  /**
   * Position between the first cloud, 0, and the second, 1; clamped to 0…1. Default 0. All objects
   * with these data show it, and dispatch `needsframe` when it changes.
   *
   * @throws InvalidArgumentError unless it is a number.
   */
  get amount(): number {
    return this.#morph.amount;
  }

  set amount(amount: number) {
    const before = this.#morph.amount;
    this.#morph.amount = amount;
    if (this.#morph.amount !== before) this.#following.change();
  }
}

class FollowedMorph implements DataEdits {
  readonly what = 'is a morph';
  version = 0;
  readonly uneditedBounds: Box3;
  readonly #data: SplatData;
  readonly #morph: SplatMorph;
  readonly #announcer: ChangeAnnouncer;

  constructor(data: SplatData, morph: SplatMorph) {
    this.uneditedBounds = data.bounds;
    this.#data = data;
    this.#morph = morph;
    this.#announcer = new ChangeAnnouncer(data);
  }

  change(): void {
    this.version++;
    this.#announcer.announce();
  }

  async follow(cloud: SplatCloud): Promise<void> {
    try {
      await followMorph(cloud, this.#morph);
      if (this.#morph.amount > 0) this.#announcer.announce();
    } catch (error) {
      tellObjects(this.#data, error);
    }
  }

  flush(cloud: SplatCloud): void {
    flushEdits(cloud);
  }

  move(_row: number, center: Vector3, place: number): void {
    center.lerp(centerAt(this.#morph, place), this.#morph.amount);
  }
}

/** Centre of the second cloud's splat at a place in storage. */
function centerAt({ packed, second }: SplatMorph, place: number): Vector3 {
  const { words, precision } = second.geometry;
  const at = words.byteOffset + 4 * GEOMETRY_WORDS[precision] * place;
  return new Vector3(...packed.origin).add(new Vector3(...new Float32Array(words.buffer, at, 3)));
}
