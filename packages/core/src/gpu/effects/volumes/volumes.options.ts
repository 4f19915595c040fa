import type { Vec3 } from '../../../data/math/mat4.ts';
import { effectOptions } from '../../../options/effect-options.ts';
import { type Volume, volumes } from './volumes.ts';

/** A volume that cuts the scene off. Options of other shapes keep the values chosen for them. */
export interface VolumeValues {
  readonly shape: 'plane' | 'box' | 'sphere';
  /** Middle of the box or of the sphere, a point of the plane; world units. */
  readonly center: Vec3;
  /** Lengths of the box's edges, world units. */
  readonly size: Vec3;
  /** Radius of the sphere, world units. */
  readonly radius: number;
  /** Direction to the plane's inside as an angle about y, degrees: 0 along z, 90 along x. */
  readonly turnDegrees: number;
  /** Elevation of the direction to the plane's inside above the xz plane, −90…90 degrees. */
  readonly tiltDegrees: number;
  /** Whether the inside stays, or everything else. */
  readonly mode: 'keep' | 'hide';
  /** Distance from the cut over which splats fade in, world units. */
  readonly softEdge: number;
}

/** The first plane cuts off the upper half; the first box and sphere keep the scene's inner part. */
export const options = effectOptions<readonly Volume[], VolumeValues>(
  volumes,
  {
    shape: {
      kind: 'choice',
      label: 'Shape of the volume',
      choices: () => ({ plane: 'Plane', box: 'Box', sphere: 'Sphere' }),
      first: 'plane',
    },
    center: {
      kind: 'vector',
      label: 'Middle',
      range: ({ center, radius }, axis) => [center[axis] - 1.5 * radius, center[axis] + 1.5 * radius],
      first: ({ center }) => center,
      along: (values) => (values.shape === 'plane' ? planeNormal(values) : null),
    },
    size: {
      kind: 'vector',
      label: 'Length',
      when: { shape: 'box' },
      range: ({ radius }) => [0, 3 * radius],
      first: ({ radius }) => [radius, radius, radius],
    },
    radius: {
      kind: 'number',
      label: 'Radius',
      when: { shape: 'sphere' },
      unit: 'units',
      range: ({ radius }) => [0, 2 * radius],
      first: ({ radius }) => 0.6 * radius,
    },
    turnDegrees: {
      kind: 'number',
      label: 'Turn',
      when: { shape: 'plane' },
      unit: 'degrees',
      range: () => [-180, 180],
      first: () => 0,
    },
    tiltDegrees: {
      kind: 'number',
      label: 'Tilt',
      when: { shape: 'plane' },
      unit: 'degrees',
      range: () => [-90, 90],
      first: () => -90,
    },
    mode: {
      kind: 'choice',
      label: 'Side that stays',
      choices: ({ shape }) =>
        shape === 'plane'
          ? { keep: 'Keep below', hide: 'Keep above' }
          : { keep: 'Keep inside', hide: 'Keep outside' },
      first: 'keep',
    },
    softEdge: {
      kind: 'number',
      label: 'Soft edge',
      unit: 'units',
      range: ({ radius }) => [0, radius / 2],
      first: () => 0,
    },
  },
  (values) => [volumeOf(values)],
);

function volumeOf(values: VolumeValues): Volume {
  const { shape, center, size, radius, mode, softEdge } = values;
  if (shape === 'box') return { shape, mode, center, size, softEdge };
  if (shape === 'sphere') return { shape, mode, center, radius, softEdge };
  return { shape, mode, point: center, normal: planeNormal(values), softEdge };
}

/**
 * The direction from a plane to its inside; length 1.
 *
 * @example
 * const normal = planeNormal({ turnDegrees: 90, tiltDegrees: 0 }); // along x
 * const effects = [volumes([{ shape: 'plane', mode: 'keep', normal }])];
 */
export function planeNormal({
  turnDegrees,
  tiltDegrees,
}: Pick<VolumeValues, 'turnDegrees' | 'tiltDegrees'>): Vec3 {
  const [turn, tilt] = [radians(turnDegrees), radians(tiltDegrees)];
  return [Math.cos(tilt) * Math.sin(turn), Math.sin(tilt), Math.cos(tilt) * Math.cos(turn)];
}

function radians(degrees: number): number {
  return (degrees * Math.PI) / 180;
}
