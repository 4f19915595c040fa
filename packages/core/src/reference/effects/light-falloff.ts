import type { LightCone, LightFalloff } from '../../gpu/effects/shadows/light-cone.ts';

/** Returns the part of a lamp's light that is left at a distance, as of three's lights. */
export function leftAt(distance: number, { decay = 2, distance: end = 0 }: LightFalloff): number {
  const within = end > 0 ? Math.min(Math.max(1 - (distance / end) ** 4, 0), 1) ** 2 : 1;
  return within / Math.max(distance ** decay, 0.01);
}

/** Returns the part of a spot light's light that is left at the cosine of an angle from its axis. */
export function leftInCone(cosine: number, { angle, penumbra = 0 }: LightCone): number {
  const [dark, bright] = [Math.cos(angle), Math.cos(angle * (1 - penumbra))];
  const t = Math.min(Math.max((cosine - dark) / Math.max(bright - dark, 1e-6), 0), 1);
  return t * t * (3 - 2 * t);
}
