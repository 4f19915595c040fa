import { InvalidArgumentError } from '../../../data/errors.ts';
import { given, wrongArgument } from '../../../data/given.ts';
import { type Mat4, translated4, type Vec3 } from '../../../data/math/mat4.ts';
import { defineEffect } from '../effect.ts';
import { checkLength, checkVector } from '../option-checks.ts';
import wgsl from './clip.wgsl?raw';

/** x, y, z, w; any length except 0. */
export type Quaternion = readonly [x: number, y: number, z: number, w: number];

interface ClipSide {
  /** Which side stays; default `inside`. */
  readonly keep?: 'inside' | 'outside';
}

/** A box, turned about its centre. */
export interface ClipBox extends ClipSide {
  readonly shape: 'box';
  readonly center: Vec3;
  /** Lengths of the box's edges, world units, 0 or more: a box without volume contains nothing. */
  readonly size: Vec3;
  /** Rotation of the box about its centre; default none. */
  readonly rotation?: Quaternion;
}

/** A sphere. */
export interface ClipSphere extends ClipSide {
  readonly shape: 'sphere';
  readonly center: Vec3;
  /** World units, 0 or more. */
  readonly radius: number;
}

/** A half-space. */
export interface ClipPlane extends ClipSide {
  readonly shape: 'plane';
  /** Any point of the plane. */
  readonly point: Vec3;
  /** Points to the inside; any length except 0. */
  readonly normal: Vec3;
}

/** A volume in world space. */
export type ClipVolume = ClipBox | ClipSphere | ClipPlane;

/** Options of `clip`. */
export interface ClipOptions {
  /** One to eight volumes; splats on the kept side of all of them stay. */
  readonly volumes: readonly ClipVolume[];
  /** Distance from the cut over which splats fade in, world units; default 0, a hard edge. */
  readonly softEdge?: number;
}

const MOST_VOLUMES = 8;
/** Volumes one by one, not as an array: see clip.wgsl. */
const FIELDS = {
  volume0: 'mat4x4f',
  volume1: 'mat4x4f',
  volume2: 'mat4x4f',
  volume3: 'mat4x4f',
  volume4: 'mat4x4f',
  volume5: 'mat4x4f',
  volume6: 'mat4x4f',
  volume7: 'mat4x4f',
  volumeCount: 'u32',
  softEdge: 'f32',
} as const;
/** Codes in clip.wgsl; negated if the outside is kept. A plane is turned around instead. */
const KINDS = { plane: 0, sphere: 1, box: 2 } as const;
const NO_AXIS = [0, 0, 0, 0];
const NO_VOLUME = /* @__PURE__ */ Array<number>(16).fill(0);
const AXES: readonly Vec3[] = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];

/**
 * Cuts a cloud off at boxes, spheres and planes: only splats whose centres are on the kept side of
 * all of them are drawn. Each splat is kept or hidden as a whole, so it extends past the surface by
 * its own size. Within `softEdge` of the surface, splats fade towards it.
 *
 * @example
 * const ball = { shape: 'sphere', center: [0, 1, 0], radius: 2 } as const;
 * const clouds = [{ cloud, effects: [clip({ volumes: [ball], softEdge: 0.1 })] }];
 */
export const clip = /* @__PURE__ */ defineEffect<ClipOptions, typeof FIELDS>({
  name: 'clip',
  label: 'Clip',
  about: 'Hides the parts of a cloud outside of boxes, spheres and planes.',
  hooks: { splat: 'clipSplat' },
  wgsl,
  fields: FIELDS,
  check(options) {
    given(options, {}, 'clip');
    const { volumes, softEdge = 0 } = options;
    if (!(Array.isArray(volumes) && volumes.length >= 1 && volumes.length <= MOST_VOLUMES)) {
      const message = `There are ${volumes?.length ?? 'no'} volumes; clip takes 1 to ${MOST_VOLUMES}. To cut nothing off, leave the effect out.`;
      throw new InvalidArgumentError('volumes', message);
    }
    for (const [index, volume] of volumes.entries()) checkVolume(`volumes[${index}]`, volume);
    checkLength('softEdge', softEdge, 'the distance over which splats fade in');
  },
  calledFor: ({ volumes }) =>
    volumes.length === 1 ? `a ${volumes[0].shape} cuts it off` : `${volumes.length} volumes cut it off`,
  valuesAt({ volumes, softEdge = 0 }, { modelMatrix, origin }) {
    // Positions in shaders are relative to the cloud's origin, so its product is computed here, in
    // float64.
    const toWorld = translated4(modelMatrix, origin);
    const at = (index: number) => (volumes[index] ? valuesOf(volumes[index], toWorld) : NO_VOLUME);
    return {
      volume0: at(0),
      volume1: at(1),
      volume2: at(2),
      volume3: at(3),
      volume4: at(4),
      volume5: at(5),
      volume6: at(6),
      volume7: at(7),
      volumeCount: volumes.length,
      softEdge,
    };
  },
});

function checkVolume(name: string, volume: ClipVolume): void {
  given(volume, {}, name);
  const { keep = 'inside' } = volume;
  if (keep !== 'inside' && keep !== 'outside')
    throw wrongArgument(`${name}.keep`, keep, 'the side that stays: "inside" or "outside"');
  switch (volume.shape) {
    case 'box': {
      const { center, size, rotation = [0, 0, 0, 1] } = volume;
      checkVector(`${name}.center`, center, 'the middle of a box in world space');
      checkVector(`${name}.size`, size, 'the lengths of a box’s edges', { isNonNegative: true });
      const rules = { length: 4, isDirection: true };
      checkVector(`${name}.rotation`, rotation, 'the quaternion x, y, z, w that turns a box', rules);
      return;
    }
    case 'sphere':
      checkVector(`${name}.center`, volume.center, 'the middle of a sphere in world space');
      checkLength(`${name}.radius`, volume.radius, 'the radius of a sphere');
      return;
    case 'plane':
      checkVector(`${name}.point`, volume.point, 'a point of a plane in world space');
      checkVector(`${name}.normal`, volume.normal, 'the normal of a plane', { isDirection: true });
      return;
    default:
      throw wrongArgument(`${name}.shape`, (volume as ClipVolume).shape, '"box", "sphere" or "plane"');
  }
}

/** Returns the matrix columns that clip.wgsl takes for one volume. */
function valuesOf(volume: ClipVolume, toWorld: Mat4): number[] {
  const side = volume.keep === 'outside' ? -1 : 1;
  const kind = side * KINDS[volume.shape];
  switch (volume.shape) {
    case 'box': {
      const { center, size, rotation = [0, 0, 0, 1] } = volume;
      const rows = axesOf(rotation).flatMap((axis) => distanceAlong(axis, center, toWorld));
      return [...rows, size[0] / 2, size[1] / 2, size[2] / 2, kind];
    }
    case 'sphere': {
      const rows = AXES.flatMap((axis) => distanceAlong(axis, volume.center, toWorld));
      return [...rows, volume.radius, 0, 0, kind];
    }
    case 'plane': {
      const [x, y, z] = volume.normal;
      const length = side * Math.hypot(x, y, z);
      const row = distanceAlong([x / length, y / length, z / length], volume.point, toWorld);
      return [...row, ...NO_AXIS, ...NO_AXIS, 0, 0, 0, KINDS.plane];
    }
  }
}

/** Returns factors of x, y, z and 1: a cloud's point's distance from `start` along `direction`. */
function distanceAlong(direction: Vec3, start: Vec3, toWorld: Mat4): number[] {
  const along = (x: number, y: number, z: number) => direction[0] * x + direction[1] * y + direction[2] * z;
  const column = (c: number) => along(toWorld[4 * c], toWorld[4 * c + 1], toWorld[4 * c + 2]);
  // Subtract first: far from the world's origin, each product would lose the difference's digits.
  const offset = along(toWorld[12] - start[0], toWorld[13] - start[1], toWorld[14] - start[2]);
  return [column(0), column(1), column(2), offset];
}

/** Returns the three axes after a rotation. */
function axesOf(rotation: Quaternion): readonly Vec3[] {
  const length = Math.hypot(...rotation);
  const [x, y, z, w] = rotation.map((component) => component / length);
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  ];
}
