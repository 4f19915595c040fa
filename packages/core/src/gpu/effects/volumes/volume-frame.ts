import { invert3, type Mat3, transform3, type Vec3 } from '../../../data/math/mat4.ts';
import { dot, scaled, unit } from '../../../data/math/vec3.ts';

/** x, y, z, w; any length except 0. */
export type Quaternion = readonly [x: number, y: number, z: number, w: number];

/** A box, turned about its centre. */
export interface BoxShape {
  readonly shape: 'box';
  /** Default: the origin. */
  readonly center?: Vec3;
  /** Lengths of the edges, 0 or more; default 1, 1, 1. */
  readonly size?: Vec3;
  /** Rotation about the centre; default none. */
  readonly rotation?: Quaternion;
}

/** A sphere. */
export interface SphereShape {
  readonly shape: 'sphere';
  /** Default: the origin. */
  readonly center?: Vec3;
  /** 0 or more; default 1. */
  readonly radius?: number;
}

/** An ellipsoid, turned about its centre. */
export interface EllipsoidShape {
  readonly shape: 'ellipsoid';
  /** Default: the origin. */
  readonly center?: Vec3;
  /** Diameters, 0 or more; default 1, 1, 1. */
  readonly size?: Vec3;
  /** Rotation about the centre; default none. */
  readonly rotation?: Quaternion;
}

/** A cylinder along y between two half-spheres, turned about its centre. */
export interface CapsuleShape {
  readonly shape: 'capsule';
  /** Default: the origin. */
  readonly center?: Vec3;
  /** 0 or more; default 1. */
  readonly radius?: number;
  /** Length of the cylinder without the half-spheres, 0 or more; default 1. */
  readonly height?: number;
  /** Rotation about the centre; default none. */
  readonly rotation?: Quaternion;
}

/** A half-space. */
export interface PlaneShape {
  readonly shape: 'plane';
  /** Any point of the plane; default: the origin. */
  readonly point?: Vec3;
  /** Points to the inside; any length except 0; default 0, 0, 1. */
  readonly normal?: Vec3;
}

/** The shape of a volume, in its own space, which `matrix` maps to the world. */
export type VolumeShape = BoxShape | SphereShape | EllipsoidShape | CapsuleShape | PlaneShape;

/** A volume in world space. */
export interface VolumeFrame {
  /** `round`: a sphere, an ellipsoid or a capsule. */
  readonly kind: 'plane' | 'box' | 'round';
  readonly center: Vec3;
  /** Directions of length 1 along which points are measured: the normals of a box's faces. */
  readonly axes: readonly Vec3[];
  /** Vectors whose sums with these measures as factors are points; the axes unless the volume is sheared. */
  readonly spans: readonly Vec3[];
  /** Half sizes along the axes: the radii of a round volume. */
  readonly half: Vec3;
  /** Half length of a capsule's middle part, along the second axis. */
  readonly halfHeight: number;
}

const ORIGIN: Vec3 = [0, 0, 0];
/** Radii below this part of the largest would divide by too little in float32. */
const THINNEST = 1e-6;

/** Returns the frame of a volume; null if it contains nothing. */
export function frameOf(volume: VolumeShape & { readonly matrix?: ArrayLike<number> }): VolumeFrame | null {
  const { matrix } = volume;
  const linear: Mat3 = matrix
    ? [matrix[0], matrix[1], matrix[2], matrix[4], matrix[5], matrix[6], matrix[8], matrix[9], matrix[10]]
    : [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const placed = (point: Vec3): Vec3 => {
    const [x, y, z] = transform3(linear, point);
    return matrix ? [x + matrix[12], y + matrix[13], z + matrix[14]] : [x, y, z];
  };
  if (volume.shape === 'plane') {
    const inverse = invert3(linear);
    if (!inverse) return null;
    const [x, y, z] = scaledToOne(volume.normal ?? [0, 0, 1]);
    const row = (c: number) => inverse[3 * c] * x + inverse[3 * c + 1] * y + inverse[3 * c + 2] * z;
    const normal = scaledToOne([row(0), row(1), row(2)]);
    const center = placed(volume.point ?? ORIGIN);
    const axes = [normal, ORIGIN, ORIGIN];
    return { kind: 'plane', center, axes, spans: axes, half: ORIGIN, halfHeight: 0 };
  }
  const turned = rotationAxes(volume.shape === 'sphere' ? undefined : volume.rotation);
  const columns = turned.map((axis) => transform3(linear, axis));
  const inverse = invert3(columns.flat());
  const half = halfSizes(volume);
  if (!inverse || half.some((length) => length === 0)) return null;
  // The rows of the inverse are normal to the faces; their lengths are 1 over the distances.
  const rows = [0, 1, 2].map((r): Vec3 => [inverse[r], inverse[3 + r], inverse[6 + r]]);
  const lengths = rows.map((row) => Math.hypot(...row));
  const inWorld = half.map((length, axis) => length / lengths[axis]);
  const least = THINNEST * Math.max(...inWorld);
  const isRound = volume.shape !== 'box';
  return {
    kind: isRound ? 'round' : 'box',
    center: placed(volume.center ?? ORIGIN),
    axes: rows.map((row, axis) => scaled(row, 1 / lengths[axis])),
    spans: columns.map((column, axis) => scaled(column, lengths[axis])),
    half: inWorld.map((length) => (isRound ? Math.max(length, least) : length)) as unknown as Vec3,
    halfHeight: volume.shape === 'capsule' ? (volume.height ?? 1) / 2 / lengths[1] : 0,
  };
}

function halfSizes(volume: Exclude<VolumeShape, { readonly shape: 'plane' }>): Vec3 {
  if (volume.shape === 'box' || volume.shape === 'ellipsoid') return scaled(volume.size ?? [1, 1, 1], 0.5);
  const { radius = 1 } = volume;
  return [radius, radius, radius];
}

/** Returns the three axes after a rotation. */
function rotationAxes(rotation: Quaternion = [0, 0, 0, 1]): readonly Vec3[] {
  const length = Math.hypot(...rotation);
  const [x, y, z, w] = rotation.map((component) => component / length);
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  ];
}

/** The squares of very short and very long directions would be 0 or infinite. */
function scaledToOne(direction: Vec3): Vec3 {
  const length = Math.hypot(...direction);
  return unit(direction.map((component) => component / length) as unknown as Vec3);
}

/** Radius about the centre of a sphere outside of which a volume with this soft edge does nothing. */
export function boundingRadius({ kind, spans, half, halfHeight }: VolumeFrame, softEdge: number): number {
  if (kind === 'plane') return Number.POSITIVE_INFINITY;
  const stretch = largestStretch(spans.flat());
  if (kind === 'box') return stretch * Math.hypot(...half.map((length) => length + softEdge));
  const [longest, shortest] = [Math.max(...half), Math.min(...half)];
  // By Kantorovich's inequality, distances to first order are at least this part of those from the centre.
  const ratio = longest / shortest;
  return stretch * (halfHeight + longest + (softEdge * (ratio + 1 / ratio)) / 2);
}

/** A bound of a column-major 3×3 matrix's stretch of vectors; exact if its columns are orthogonal. */
export function largestStretch(m: ArrayLike<number>): number {
  const columns = [0, 3, 6].map((at): Vec3 => [m[at], m[at + 1], m[at + 2]]);
  // By Gershgorin's theorem: no eigenvalue of the Gram matrix exceeds its largest row sum.
  return Math.sqrt(Math.max(...columns.map((a) => columns.reduce((sum, b) => sum + Math.abs(dot(a, b)), 0))));
}

/** Returns the distance of a point of the world from the surface of a volume, negative inside. */
export function distanceFrom({ kind, center, axes, half, halfHeight }: VolumeFrame, point: Vec3): number {
  const offset: Vec3 = [point[0] - center[0], point[1] - center[1], point[2] - center[2]];
  const [x, y, z] = axes.map((axis) => dot(axis, offset));
  if (kind === 'plane') return -x;
  if (kind === 'box') {
    const beyond = [Math.abs(x) - half[0], Math.abs(y) - half[1], Math.abs(z) - half[2]];
    const outside = Math.hypot(...beyond.map((length) => Math.max(length, 0)));
    return outside + Math.min(Math.max(...beyond), 0);
  }
  const inRadii = [x / half[0], (y - clamped(y, halfHeight)) / half[1], z / half[2]];
  const radii = Math.hypot(...inRadii);
  if (radii === 0) return -Math.min(...half);
  return (radii - 1) / Math.hypot(...inRadii.map((part, axis) => part / radii / half[axis]));
}

function clamped(value: number, most: number): number {
  return Math.min(Math.max(value, -most), most);
}
