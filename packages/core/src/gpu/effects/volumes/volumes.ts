import { InvalidArgumentError } from '../../../data/errors.ts';
import { checkKind, given, wrongArgument } from '../../../data/given.ts';
import { invert3, linearPart, transform3, translated4, type Vec3 } from '../../../data/math/mat4.ts';
import { type EffectPlace, effectFunction, numbersOf } from '../effect.ts';
import { EFFECT_LIST } from '../effect-list.ts';
import { checkLength, checkRange, checkVector } from '../option-checks.ts';
import { boundingRadius, distanceFrom, frameOf, largestStretch, type VolumeShape } from './volume-frame.ts';
import { cellsAlong, gridOf, gridVectors, type Slab, type VolumeReach } from './volume-grid.ts';
import wgsl from './volumes.wgsl?raw';

export type {
  BoxShape,
  CapsuleShape,
  EllipsoidShape,
  PlaneShape,
  Quaternion,
  SphereShape,
  VolumeShape,
} from './volume-frame.ts';

/** What a volume does to the splats whose centres are in it. */
export type VolumeChange =
  /** Hides splats inside; `keep`: splats outside. */
  | { readonly mode: 'hide' | 'keep' }
  /** Multiplies the opacity by `opacity`, 0…1. */
  | { readonly mode: 'fade'; readonly opacity: number }
  /** Multiplies colours by red, green and blue, sRGB-encoded, 0 or more. */
  | { readonly mode: 'tint'; readonly tint: Vec3 }
  /** Moves splats by `offset`, in the volume's own space. */
  | { readonly mode: 'displace'; readonly offset: Vec3 };

/** A volume that changes splats. */
export type Volume = VolumeShape &
  VolumeChange & {
    /**
     * Volume to world, column-major 4×4, affine; default: the shape is given in world space. A volume
     * that is flattened by it, or that has a size of 0, contains nothing.
     */
    readonly matrix?: ArrayLike<number>;
    /** Distance from the surface over which the change fades out, world units; default 0, a hard edge. */
    readonly softEdge?: number;
    /** Whether the volume acts outside instead of inside; default false. */
    readonly invert?: boolean;
  };

/** Most volumes of a cloud. */
const MOST_VOLUMES = 256;
/** Codes in volumes.wgsl. */
const KINDS = { plane: 0, box: 1, round: 2 } as const;
const SCALES_OPACITY = 0;
const DISPLACES = 1;
/** A volume in the list of volumes.wgsl, in the order of the shader, in the cloud's space about its origin. */
type PackedVolume = {
  /** Middle and squared radius of a sphere outside of which the volume does nothing; −1: it acts everywhere. */
  readonly bounds: readonly number[];
  /** Three rows that map a point x, y, z, 1 to its distances along the volume's axes, world units. */
  readonly rows: readonly number[];
  /** Half sizes along these axes, world units. */
  readonly half: readonly number[];
  readonly kind: number;
  readonly softEdge: number;
  /** −1 if the outside is meant, else 1. */
  readonly side: number;
  /** Of a capsule's middle part. */
  readonly halfHeight: number;
  readonly unused: 0;
  /** Factors of the colour, the displacement or the factor of the opacity; w: which of the latter. */
  readonly change: readonly number[];
};
/** vec4f of a volume. */
const VOLUME_VECTORS = 7;
/** Beyond this, squares of lengths exceed float32. */
const LONGEST = 1e18;
const LARGEST_F32 = 3.4028234663852886e38;
/** Bounds of a volume that may act on any splat. */
const EVERYWHERE = [0, 0, 0, -1];
/** Rows of a half-space that all points are outside of. */
const NOWHERE = [0, 0, 0, -LARGEST_F32, 0, 0, 0, 0, 0, 0, 0, 0];
const NO_SIZE = [0, 0, 0];

/**
 * Changes the splats in boxes, spheres, ellipsoids, capsules and half-spaces: hides them, or all
 * others, fades, tints or displaces them. At most 256 volumes act in the order of the list, on each
 * splat as a whole by its centre. `tint` acts last, where splats are after all displacements.
 *
 * A volume acts fully up to its surface. Beyond it, the change fades out over `softEdge`.
 *
 * @example
 * const crop = { shape: 'box', mode: 'keep', center: [0, 1, 0], size: [2, 2, 2] } as const;
 * const lamp = { shape: 'sphere', mode: 'tint', tint: [1.5, 1.2, 0.8], radius: 0.5, softEdge: 1 } as const;
 * const clouds = [{ cloud, effects: [volumes([crop, lamp])] }];
 */
export const volumes = /* @__PURE__ */ effectFunction<readonly Volume[]>({
  ...EFFECT_LIST.volumes,
  wgsl,
  check(list) {
    checkKind('volumes', list, 'a list');
    if (list.length > MOST_VOLUMES) {
      const message = `There are ${list.length} volumes; a cloud takes up to ${MOST_VOLUMES}.`;
      throw new InvalidArgumentError('volumes', message);
    }
    for (const [index, volume] of list.entries()) checkVolume(`volumes[${index}]`, volume);
  },
  calledFor(list) {
    if (list.length === 0) return null;
    return list.length === 1 ? reasonOf(list[0]) : `${list.length} volumes change it`;
  },
  hooksFor: (list) => [
    ...(list.some((volume) => !isTint(volume)) ? (['splat'] as const) : []),
    ...(list.some(isTint) ? (['color'] as const) : []),
  ],
  list: {
    joined: (earlier, later) => [...earlier, ...later],
    length: ({ length }) => listVectors(length) + gridVectors(length, cellsOf(length)),
    at(list, place) {
      const ordered = [...list.filter((volume) => !isTint(volume)), ...list.filter(isTint)];
      const packed = ordered.map((volume) => packedVolume(volume, place));
      const changing = ordered.length - list.filter(isTint).length;
      const cells = cellsOf(list.length);
      const grid = gridOf(reachesOf(packed), cells);
      const numbers = packed.flatMap(numbersOf);
      return [changing, list.length, cells, 0, ...numbers, ...grid].map((value) =>
        Math.min(Math.max(value, -LARGEST_F32), LARGEST_F32),
      );
    },
  },
  reach: (list) => ({ displacement: 0, growth: 1, displacementWorld: displacementOf(list) }),
});

/** Returns the number of vec4f of a list of so many volumes, without its grid. */
function listVectors(volumeCount: number): number {
  return 1 + VOLUME_VECTORS * volumeCount;
}

function cellsOf(volumeCount: number): number {
  return cellsAlong(volumeCount, listVectors(volumeCount));
}

/**
 * Returns where volumes may act on splats that none of them has moved yet, with room for the
 * displacements by the volumes before them.
 */
function reachesOf(volumes: readonly PackedVolume[]): VolumeReach[] {
  let moved = 0;
  return volumes.map((volume) => {
    const [x, y, z, squaredRadius] = volume.bounds;
    const radius = Math.sqrt(squaredRadius) + moved;
    const isBounded = squaredRadius >= 0 && radius < LONGEST;
    const reach = {
      sphere: isBounded ? { center: [x, y, z], radius } : null,
      slabs: isBounded ? slabsOf(volume, moved) : [],
    };
    const [offsetX, offsetY, offsetZ, change] = volume.change;
    if (change === DISPLACES) moved += Math.hypot(offsetX, offsetY, offsetZ);
    return reach;
  });
}

/** Returns the slabs along its axes that a bounded volume acts within, each wider by `moved`. */
function slabsOf({ rows, half, kind, softEdge, halfHeight }: PackedVolume, moved: number): Slab[] {
  const [sizeX, sizeY, sizeZ] = half;
  // An ellipsoid's distances are to first order, so its edge may be wider than `softEdge`.
  if (kind === KINDS.round && softEdge > 0 && (sizeX !== sizeY || sizeX !== sizeZ)) return [];
  return [sizeX, sizeY + halfHeight, sizeZ].map((reach, axis) => {
    const factors = rows.slice(4 * axis, 4 * axis + 4);
    // With room for the rounding of float32.
    const room = moved * Math.hypot(...factors.slice(0, 3)) + 1e-5 * Math.abs(factors[3]);
    const most = 1.0001 * (reach + softEdge) + room;
    return { factors, most };
  });
}

const isTint = ({ mode }: Volume) => mode === 'tint';

const DOES: Readonly<Record<Volume['mode'], string>> = {
  hide: 'hides the splats inside of it',
  keep: 'hides the splats outside of it',
  fade: 'makes splats fainter',
  tint: 'tints splats',
  displace: 'displaces splats',
};

function reasonOf({ shape, mode }: Volume): string {
  return `${shape === 'ellipsoid' ? 'an' : 'a'} ${shape} ${DOES[mode]}`;
}

/** Largest distance that all volumes together move a splat, world units. */
function displacementOf(list: readonly Volume[]): number {
  return list.reduce(
    (sum, volume) => sum + (volume.mode === 'displace' ? Math.hypot(...worldOffset(volume)) : 0),
    0,
  );
}

function worldOffset({ offset, matrix }: Volume & { readonly mode: 'displace' }): Vec3 {
  return matrix ? transform3(linearPart(matrix), offset) : offset;
}

function checkVolume(name: string, volume: Volume): void {
  given(volume, {}, name);
  const { matrix, softEdge = 0, invert = false } = volume;
  if (typeof invert !== 'boolean') throw wrongArgument(`${name}.invert`, invert, 'true or false');
  if (matrix !== undefined)
    checkVector(`${name}.matrix`, matrix, 'a volume’s matrix to the world', { length: 16 });
  checkLength(`${name}.softEdge`, softEdge, 'the distance over which the change fades out');
  checkShape(name, volume);
  switch (volume.mode) {
    case 'hide':
    case 'keep':
      return;
    case 'fade':
      checkRange(`${name}.opacity`, volume.opacity, 1, 'the factor of a splat’s opacity');
      return;
    case 'tint':
      checkVector(`${name}.tint`, volume.tint, 'a factor for red, green and blue', { isNonNegative: true });
      return;
    case 'displace':
      checkVector(`${name}.offset`, volume.offset, 'how far splats are moved along x, y and z');
      return;
    default: {
      const { mode } = volume as Volume;
      throw wrongArgument(`${name}.mode`, mode, '"hide", "keep", "fade", "tint" or "displace"');
    }
  }
}

function checkShape(name: string, volume: VolumeShape): void {
  const { shape } = volume;
  if (shape === 'plane') {
    const { point = [0, 0, 0], normal = [0, 0, 1] } = volume;
    checkVector(`${name}.point`, point, 'a point of a plane');
    checkVector(`${name}.normal`, normal, 'the normal of a plane', { isDirection: true });
    return;
  }
  if (!(['box', 'sphere', 'ellipsoid', 'capsule'] as unknown[]).includes(shape))
    throw wrongArgument(`${name}.shape`, shape, '"box", "sphere", "ellipsoid", "capsule" or "plane"');
  const { center = [0, 0, 0] } = volume;
  checkVector(`${name}.center`, center, `the middle of the ${shape}`);
  if (volume.shape !== 'sphere') {
    const { rotation = [0, 0, 0, 1] } = volume;
    const rules = { length: 4, isDirection: true };
    checkVector(`${name}.rotation`, rotation, `the quaternion x, y, z, w that turns the ${shape}`, rules);
  }
  if (volume.shape === 'box' || volume.shape === 'ellipsoid') {
    const { size = [1, 1, 1] } = volume;
    checkVector(`${name}.size`, size, `the lengths of the ${shape} along its axes`, { isNonNegative: true });
  } else {
    const { radius = 1 } = volume;
    checkLength(`${name}.radius`, radius, `the radius of the ${shape}`);
  }
  if (volume.shape === 'capsule') {
    const { height = 1 } = volume;
    checkLength(`${name}.height`, height, 'the length of the capsule’s middle part');
  }
}

function packedVolume(volume: Volume, { modelMatrix, origin }: EffectPlace): PackedVolume {
  const { softEdge = 0 } = volume;
  // Positions in shaders are relative to the cloud's origin, so its product is computed here, in
  // float64.
  const toWorld = translated4(modelMatrix, origin);
  const toCloud = invert3(linearPart(toWorld));
  const frame = frameOf(volume);
  const isOutside = actsOutside(volume);
  const side = isOutside ? -1 : 1;
  const change = changeOf(volume, toCloud);
  if (!frame) {
    const nowhere = { bounds: EVERYWHERE, rows: NOWHERE, half: NO_SIZE, kind: KINDS.plane };
    return { ...nowhere, softEdge: 0, side, halfHeight: 0, unused: 0, change };
  }
  const { kind, center, axes, half, halfHeight } = frame;
  const rows = axes.flatMap((axis) => distanceAlong(axis, center, toWorld));
  const bounds = isOutside
    ? EVERYWHERE
    : boundsInCloud(center, boundingRadius(frame, softEdge), toWorld, toCloud);
  return { bounds, rows, half, kind: KINDS[kind], softEdge, side, halfHeight, unused: 0, change };
}

/** Whether a volume acts on the splats outside of it. */
function actsOutside({ mode, invert = false }: Volume): boolean {
  return invert !== (mode === 'keep');
}

/**
 * Returns a function for the distance of a point of the world from the part of space that a volume
 * acts on, world units; 0 or less inside of that part.
 *
 * @example
 * const clearance = volumeClearance({ shape: 'sphere', mode: 'hide', radius: 2 });
 * clearance([3, 0, 0]); // 1
 */
export function volumeClearance(volume: Volume): (point: Vec3) => number {
  const side = actsOutside(volume) ? -1 : 1;
  const frame = frameOf(volume);
  return (point) => side * (frame ? distanceFrom(frame, point) : Number.POSITIVE_INFINITY);
}

function changeOf(volume: Volume, toCloud: ArrayLike<number> | null): number[] {
  switch (volume.mode) {
    case 'tint':
      return [...volume.tint, 0];
    case 'displace':
      // A cloud that its matrix flattens is not displaced.
      return [...(toCloud ? transform3(toCloud, worldOffset(volume)) : [0, 0, 0]), DISPLACES];
    case 'fade':
      return [volume.opacity, 0, 0, SCALES_OPACITY];
    default:
      return [0, 0, 0, SCALES_OPACITY];
  }
}

/** Returns the middle and the squared radius in the cloud's space of a sphere in the world; or −1. */
function boundsInCloud(
  center: Vec3,
  radius: number,
  toWorld: ArrayLike<number>,
  toCloud: ArrayLike<number> | null,
): number[] {
  if (!toCloud || !(radius < LONGEST)) return EVERYWHERE;
  const middle = transform3(
    toCloud,
    center.map((coordinate, axis) => coordinate - toWorld[12 + axis]),
  );
  const away = Math.hypot(...middle);
  // With room for the rounding of float32.
  const inCloud = 1.0001 * radius * largestStretch(toCloud) + 1e-6 * away;
  return inCloud < LONGEST && away < LONGEST ? [...middle, inCloud ** 2] : EVERYWHERE;
}

/** Returns factors of x, y, z and 1: a cloud's point's distance from `start` along `direction`. */
function distanceAlong(direction: Vec3, start: Vec3, toWorld: ArrayLike<number>): number[] {
  const along = (x: number, y: number, z: number) => direction[0] * x + direction[1] * y + direction[2] * z;
  const column = (c: number) => along(toWorld[4 * c], toWorld[4 * c + 1], toWorld[4 * c + 2]);
  // Subtract first: far from the world's origin, each product would lose the difference's digits.
  const offset = along(toWorld[12] - start[0], toWorld[13] - start[1], toWorld[14] - start[2]);
  return [column(0), column(1), column(2), offset];
}
