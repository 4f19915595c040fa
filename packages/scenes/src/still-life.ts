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
  const { splats = STILL_LIFE_SPLATS, seed = 1, shDegree = 3 } = options;
  if (!Number.isInteger(splats) || splats < STILL_LIFE_MIN_SPLATS || splats > STILL_LIFE_MAX_SPLATS) {
    throw new RangeError(
      `stillLife: splats is ${splats}; give a whole number from ${STILL_LIFE_MIN_SPLATS} to ${STILL_LIFE_MAX_SPLATS}.`,
    );
  }
  const builder = new SplatBuilder(splats, shDegree);
  const shader = new Shader(shDegree, makeOcclusionField(), REFLECTED_BALLS, {
    radius: TABLE_RADIUS,
    color: TABLE_TINT,
  });
  const size = Math.min(1, splats / STILL_LIFE_SPLATS);
  const counts = apportion(
    splats,
    PARTS.map((part) => part.weight * size ** ROLE_EXPONENT[part.role ?? 'subject']),
    MIN_PART_SPLATS,
  );
  const fibreWidening = (STILL_LIFE_SPLATS / splats) ** 0.5;
  PARTS.forEach((part, index) => {
    const prng = new Prng(seedFor(seed, part.name));
    part.emit(counts[index], { builder, shader, prng, fibreWidening });
  });
  return builder.build();
}
