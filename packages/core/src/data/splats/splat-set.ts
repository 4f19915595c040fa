/** Degree of the spherical harmonics that a set of splats carries. */
export type ShDegree = 0 | 1 | 2 | 3;

/** Coefficients per colour channel above degree 0, by degree: 0, 3, 8, 15. */
export const SH_REST_COEFFICIENTS: Readonly<Record<ShDegree, number>> = { 0: 0, 1: 3, 2: 8, 3: 15 };

/**
 * SH coefficients of one splat above degree 0, in all three colour channels.
 *
 * @example
 * const count = coefficientsPerSplat(3); // 45
 */
export function coefficientsPerSplat(degree: ShDegree): number {
  return 3 * SH_REST_COEFFICIENTS[degree];
}

/** Spherical harmonics above degree 0 of N splats, as trained. */
export interface TrainedHarmonics {
  readonly degree: ShDegree;
  /** N · 3K in ascending (degree, order), each as r, g, b. K = SH_REST_COEFFICIENTS[degree]. */
  readonly coefficients: Float32Array;
}

/**
 * Reasons to drop a splat; where several hold, the first is counted. The GPU counts them by their index.
 * Motions are read on the CPU alone.
 */
export const DROP_REASONS = [
  'non-finite-position',
  'non-finite-scale',
  'non-finite-rotation',
  'non-finite-opacity',
  'non-finite-color',
] as const;

/** Why a splat in the application's buffers is not drawn, by the number that pack-buffers has for it. */
export const GPU_FAULTS = [...DROP_REASONS, 'out-of-bounds'] as const;

/** Why a splat was dropped. */
export type DropReason = (typeof DROP_REASONS)[number] | 'non-finite-motion';

/** Number of dropped splats by reason; reasons that did not occur are absent. */
export type DropCounts = Partial<Record<DropReason, number>>;

/** Adds `counts` to `total`. */
export function addDrops(total: DropCounts, counts: DropCounts): void {
  for (const [reason, count] of Object.entries(counts) as [DropReason, number][])
    total[reason] = (total[reason] ?? 0) + count;
}

/** Facts that a file states about itself. */
export interface FileFacts {
  /** Name of the format, e.g. `spz`. */
  readonly format: string;
  /**
   * Version or kind within the format, e.g. `3` or `binary_little_endian`; absent where there is
   * only one.
   */
  readonly variant?: string;
  /** Program that wrote the file, if the file says so. */
  readonly writer?: string;
  /** True where the file asks for splats to be sorted by distances instead of depths. */
  readonly isSortedByDistance?: boolean;
  /** Differences between file and picture, a sentence each; absent if there are none. */
  readonly notes?: readonly string[];
  /** Frames of the file, of which these splats are one; absent in files without frames. */
  readonly frames?: {
    readonly count: number;
    /** Frames per second. */
    readonly perS: number;
    /** Size of the file. */
    readonly bytes: number;
  };
}

/**
 * Splats on the CPU without their harmonics: a column per property, N = `count` rows, in any order.
 * Values are as trained (log scales, logit opacity): readers change nothing, and only drop and
 * count rows that are not finite.
 */
export interface SplatColumns {
  /** Number of splats, N. */
  readonly count: number;
  /** Scene-space origin of positions, in float64: large coordinates keep their precision. */
  readonly origin: readonly [number, number, number];
  /** 3N: x, y, z relative to `origin`. */
  readonly positions: Float32Array;
  /** 3N: natural logarithm of the standard deviation along each local axis; −Infinity: flat. */
  readonly logScales: Float32Array;
  /** 4N: quaternion w, x, y, z; of any length above zero. Zero means the identity. */
  readonly rotations: Float32Array;
  /** N: logit of the opacity; ±Infinity allowed. */
  readonly opacityLogits: Float32Array;
  /** 3N: spherical-harmonics coefficient of degree 0 for r, g, b. */
  readonly colorDc: Float32Array;
  /** N: each splat's row in its file, 0-based; picking returns it. */
  readonly fileIndices: Uint32Array;
  /**
   * 15N: how each splat moves, turns, comes and goes: time, log duration, velocity, acceleration, jerk
   * and turn (`MOTION_SLOT`). Absent if the splats stand still.
   */
  readonly motion?: Float32Array;
  /** Rows of the file that were dropped, by reason. */
  readonly dropped: DropCounts;
  /** Whether splats were trained with an antialias filter; absent if the format does not say. */
  readonly isAntialiased?: boolean;
  /** Absent where the splats are of no file. */
  readonly fileFacts?: FileFacts;
}

/** Number of splats, and some of the columns of geometry. */
export type SomeColumns = Pick<SplatColumns, 'count'> &
  Partial<Pick<SplatColumns, 'positions' | 'logScales' | 'rotations' | 'opacityLogits' | 'colorDc'>>;

/**
 * Splats on the CPU. Harmonics are as trained, like all else, unless the type says otherwise:
 * readers return `SplatSet<PackedHarmonics>`, since harmonics are most of a scene's bytes and are
 * packed as they are read.
 */
export interface SplatSet<Harmonics extends { readonly degree: ShDegree } = TrainedHarmonics>
  extends SplatColumns {
  /** Spherical harmonics above degree 0. */
  readonly harmonics: Harmonics;
}

/** The antialias filter that all parts of a scene name; undefined if they differ or name none. */
export function agreedAntialiasing(
  parts: readonly { readonly isAntialiased?: boolean }[],
): boolean | undefined {
  const [{ isAntialiased }] = parts;
  return parts.every((part) => part.isAntialiased === isAntialiased) ? isAntialiased : undefined;
}
