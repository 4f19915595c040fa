import { wrongArgument } from '../../../data/given.ts';
import { checkLength, checkRange, isFiniteF32 } from '../option-checks.ts';

/** How the light of a lamp falls off with the distance, as three's lights do. */
export interface LightFalloff {
  /** Exponent of the distance that the light is divided by. Default: 2. */
  readonly decay?: number;
  /** Distance at which the light ends, world units; 0: nowhere. Default: 0. */
  readonly distance?: number;
}

/** The cone of a spot light. */
export interface LightCone extends LightFalloff {
  /** Angle from the axis to the edge of the cone, radians, above 0 and below π/2. */
  readonly angle: number;
  /** Part of the angle over which the light fades out, 0…1. Default: 0. */
  readonly penumbra?: number;
}

/** @throws InvalidArgumentError */
export function checkFalloff(name: string, { decay = 2, distance = 0 }: LightFalloff): void {
  checkLength(`${name}.distance`, distance, 'where the light ends');
  if (!(isFiniteF32(decay) && decay >= 0))
    throw wrongArgument(`${name}.decay`, decay, 'an exponent of the distance, 0 or more');
}

/** @throws InvalidArgumentError */
export function checkCone(name: string, cone: LightCone): void {
  const { angle, penumbra = 0 } = cone;
  if (!(angle > 0 && angle < Math.PI / 2))
    throw wrongArgument(`${name}.angle`, angle, 'radians above 0 and below π/2');
  checkRange(`${name}.penumbra`, penumbra, 1, 'the part of the angle over which the light fades out');
  checkFalloff(name, cone);
}

/** Returns the cosines of a cone's edge and of the edge of its bright middle. */
export function cosinesOf({ angle, penumbra = 0 }: LightCone): readonly [edge: number, middle: number] {
  const edge = Math.cos(angle);
  // smoothstep needs two edges.
  return [edge, Math.max(Math.cos(angle * (1 - penumbra)), edge + 1e-6)];
}
