import type { AccuracyPreset, Camera, DropCounts, SplatSet } from '@websplatter/core';

/** The part of rendering that a case is hard on; the groups of the catalogue, in its order. */
export const HARD_CASE_GROUPS = [
  'scale',
  'rotation',
  'opacity',
  'input',
  'depth',
  'camera',
  'world',
  'colour',
  'accumulate',
  'counts',
  'sort',
  'device',
] as const;
export type HardCaseGroup = (typeof HARD_CASE_GROUPS)[number];

/** Splats as a case gives them: made, or as the bytes of a file, which then takes the way that every file takes. */
export type HardSplats = { readonly set: SplatSet } | { readonly file: Uint8Array<ArrayBuffer> };

export type HardCloud = HardSplats & {
  /** Column-major, float64; default the identity. */
  readonly modelMatrix?: ArrayLike<number>;
};

/** How far the engine may be from float64, where the usual bound does not fit, and why. */
export interface BoundException {
  /** PSNR of raw values over black, dB. */
  readonly minPsnrDb: number;
  /** Why precision or definition allows no better; one sentence. */
  readonly cause: string;
}

interface HardCaseBase {
  /** Kebab-case, unique: `needle-aspect-1e6`. */
  readonly name: string;
  readonly group: HardCaseGroup;
  /** What renderers do that get it wrong; one sentence. */
  readonly breaks: string;
}

/** A small scene, seen by cameras, whose picture float64 defines. */
export interface SceneCase extends HardCaseBase {
  readonly kind: 'scene';
  readonly clouds: () => readonly HardCloud[];
  /** Cameras by name, for a picture of this aspect ratio (width by height). */
  readonly cameras: (aspect: number) => Readonly<Record<string, Camera>>;
  /** Picture size where 64×64 will not do. */
  readonly size?: { readonly widthPx: number; readonly heightPx: number };
  /** Splats that reading must leave out, by reason, for cases given as files. */
  readonly dropped?: DropCounts;
  /** Presets whose usual bound does not fit: `reference` 55 dB; `high` and `balanced` are only reported without one. */
  readonly bounds?: Partial<Record<AccuracyPreset, BoundException>>;
  /** Most workgroups in one dimension of a dispatch; default the device's limit. */
  readonly maxWorkgroupsPerDimension?: number;
  /** Frames that must be the same bit for bit; default 2, for cases of ties 100 (and a second device). */
  readonly identicalFrames?: number;
  /**
   * Decisions at a threshold may fall either way within rounding: then stages are checked for that alone and the picture
   * is not. Says which threshold.
   */
  readonly decidesAtThreshold?: string;
}

/** Bytes that are no splats: reading them must fail with this code. */
export interface RefusedFileCase extends HardCaseBase {
  readonly kind: 'refused-file';
  readonly file: () => Uint8Array<ArrayBuffer>;
  /** `code` of the SplatFileError. */
  readonly code: string;
}

/** Keys for the sort alone: the result must be the stable ascending order. */
export interface SortCase extends HardCaseBase {
  readonly kind: 'sort';
  readonly keys: () => Uint32Array;
  /** Keys are below 2^keyBits. */
  readonly keyBits: 16 | 24 | 27 | 32;
  readonly maxWorkgroupsPerDimension?: number;
}

/** A scene on a device that has less than it could: picture and errors as in any scene case. */
export interface DeviceCase extends Omit<SceneCase, 'kind'> {
  readonly kind: 'device';
  /** What the device is made with; features named in `without` are not requested, limits are WebGPU's defaults. */
  readonly without: readonly string[];
}

/** Arithmetic that would take more memory than there is to run: null where it holds, or what is wrong. */
export interface ArithmeticCase extends HardCaseBase {
  readonly kind: 'arithmetic';
  readonly check: () => string | null;
}

export type HardCase = SceneCase | RefusedFileCase | SortCase | DeviceCase | ArithmeticCase;
