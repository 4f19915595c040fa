import type { ShDegree, SplatSet } from '@websplatter/core';
import { makeOcclusionField, REFLECTED_BALLS, TABLE_RADIUS, TABLE_TINT } from './arrangement.ts';
import { STILL_LIFE_SPLATS } from './builtin-scene-facts.ts';
import { clothParts } from './cloth.ts';
import { fruitParts } from './fruit.ts';
import { landscapeParts } from './landscape.ts';
import type { Part, PartRole } from './part.ts';
import { plumeParts } from './plumes.ts';
import { Prng, seedFor } from './prng.ts';
import { Shader } from './shading.ts';
import { SplatBuilder } from './splat-builder.ts';
import { apportion } from './surface-sampling.ts';
import { tablewareParts } from './tableware.ts';

/** Fewer splats than this cannot close the scene's surfaces. */
export const STILL_LIFE_MIN_SPLATS = 1_000;
export const STILL_LIFE_MAX_SPLATS = 1_000_000;

export interface StillLifeOptions {
  /** Exact number of splats, {@link STILL_LIFE_MIN_SPLATS} to {@link STILL_LIFE_MAX_SPLATS}. */
  readonly splats?: number;
  /** Any integer; the same seed gives the same scene, bit for bit, on the same engine. */
  readonly seed?: number;
  /** Degree of the spherical harmonics; 0 leaves out everything that depends on the direction. */
  readonly shDegree?: ShDegree;
}

/** Every part gets at least this many splats, so that none vanishes from the smallest scenes. */
const MIN_PART_SPLATS = 6;

/** A part's share at `splats` over that at full size goes as this power of `splats` over the full number. */
const ROLE_EXPONENT: Readonly<Record<PartRole, number>> = {
  subject: 0,
  detail: 0.3,
  sparse: -0.3,
  ground: -0.12,
};

const PARTS: readonly Part[] = [
  ...landscapeParts,
  ...tablewareParts,
  ...clothParts,
  ...fruitParts,
  ...plumeParts,
];

/**
 * A table laid outdoors on a late afternoon: a glazed vase of pampas plumes, a jade bowl of fruit, a glass bottle, a
 * steel ball, a loaf and a linen runner, with hills and sky around. Metres, y up, the table's top at y = 0, about
 * 1.2 m across; the sky is 110 m away. Light is baked into spherical harmonics; colours are sRGB-encoded.
 *
 * @throws RangeError when `splats` is not a whole number in range
 */
export function stillLife(options: StillLifeOptions = {}): SplatSet {
  return madeOf(countedParts(options), options);
}

/**
 * One of `of` shares of the scene, of about equal work, to be made at the same time: `mergeSplats` of all of them in order is
 * the scene, bit for bit.
 *
 * @param share 0 to `of` − 1
 * @throws RangeError as {@link stillLife}, and for a share that does not exist
 */
export function stillLifeShare(share: number, of: number, options: StillLifeOptions = {}): SplatSet {
  if (!(Number.isInteger(of) && Number.isInteger(share) && share >= 0 && share < of)) {
    throw new RangeError(
      `stillLifeShare: share is ${share} of ${of}; give whole numbers, 0 to one below the number of shares.`,
    );
  }
  return madeOf(shareOf(countedParts(options), share, of), options);
}

interface CountedPart {
  readonly part: Part;
  readonly count: number;
}

/** All parts, with the numbers of their splats. */
function countedParts({ splats = STILL_LIFE_SPLATS }: StillLifeOptions): readonly CountedPart[] {
  if (!Number.isInteger(splats) || splats < STILL_LIFE_MIN_SPLATS || splats > STILL_LIFE_MAX_SPLATS) {
    throw new RangeError(
      `stillLife: splats is ${splats}; give a whole number from ${STILL_LIFE_MIN_SPLATS} to ${STILL_LIFE_MAX_SPLATS}.`,
    );
  }
  const size = Math.min(1, splats / STILL_LIFE_SPLATS);
  const counts = apportion(
    splats,
    PARTS.map((part) => part.weight * size ** ROLE_EXPONENT[part.role ?? 'subject']),
    MIN_PART_SPLATS,
  );
  return PARTS.map((part, index) => ({ part, count: counts[index] }));
}

/** Successive parts: those whose middle lies in the share, if all work stands in a row. */
function shareOf(parts: readonly CountedPart[], share: number, of: number): readonly CountedPart[] {
  const works = parts.map(({ part: { work = 1 }, count }) => work * count);
  const total = works.reduce((sum, work) => sum + work, 0);
  let before = 0;
  return parts.filter((_, index) => {
    const middle = before + works[index] / 2;
    before += works[index];
    return Math.floor((of * middle) / total) === share;
  });
}

function madeOf(parts: readonly CountedPart[], options: StillLifeOptions): SplatSet {
  const { splats = STILL_LIFE_SPLATS, seed = 1, shDegree = 3 } = options;
  const builder = new SplatBuilder(
    parts.reduce((sum, { count }) => sum + count, 0),
    shDegree,
  );
  const shader = new Shader(shDegree, makeOcclusionField(), REFLECTED_BALLS, {
    radius: TABLE_RADIUS,
    color: TABLE_TINT,
  });
  const fibreWidening = (STILL_LIFE_SPLATS / splats) ** 0.5;
  for (const { part, count } of parts) {
    const prng = new Prng(seedFor(seed, part.name));
    part.emit(count, { builder, shader, prng, fibreWidening });
  }
  return builder.build();
}
