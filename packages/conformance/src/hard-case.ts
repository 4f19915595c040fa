import type {
  AccuracyPreset,
  Camera,
  DropCounts,
  GeometryPrecision,
  Harmonics,
  SceneFraming,
  SplatSet,
} from '@websplatter/core';

/** Groups of the catalogue in its order: the part of rendering that a case strains. */
export const HARD_CASE_GROUPS = [
  'scale',
  'rotation',
  'opacity',
  'input',
  'depth',
  'camera',
  'world',
  'placement',
  'colour',
  'palette',
  'accumulate',
  'tiles',
  'counts',
  'sort',
  'framing',
  'device',
] as const;
export type HardCaseGroup = (typeof HARD_CASE_GROUPS)[number];

/** Splats of a case: made by code, or the bytes of a file, which is read like any other. */
export type HardSplats = { readonly set: SplatSet<Harmonics> } | { readonly file: Uint8Array<ArrayBuffer> };

export type HardCloud = HardSplats & {
  /** Column-major, float64; default the identity. */
  readonly modelMatrix?: ArrayLike<number>;
};

/** Bound on the difference from float64 for cases unfit for the usual bound, and the reason. */
export interface BoundException {
  /** PSNR of raw values over black, dB. */
  readonly minPsnrDb: number;
  /**
   * The same if the device blends halves by truncation (`truncatesHalves`), for cases where that
   * shows; dB.
   */
  readonly minPsnrTruncatedDb?: number;
  /** Why precision or definition allows no better; one sentence. */
  readonly cause: string;
}

interface HardCaseBase {
  /** Kebab-case, unique: `needle-aspect-1e6`. */
  readonly name: string;
  readonly group: HardCaseGroup;
  /** How renderers get it wrong; one sentence. */
  readonly breaks: string;
}

/** A small scene and its cameras; float64 defines the images. */
export interface SceneCase extends HardCaseBase {
  readonly kind: 'scene';
  readonly clouds: () => readonly HardCloud[];
  /**
   * The same scene given otherwise, where `clouds` may lose something before it is drawn: float64
   * images are of this. Default `clouds`, as they were read.
   */
  readonly truth?: () => readonly HardCloud[];
  /** Cameras by name, for images of this aspect ratio (width by height). */
  readonly cameras: (aspect: number) => Readonly<Record<string, Camera>>;
  /** Image size where 64×64 does not suffice. */
  readonly size?: { readonly widthPx: number; readonly heightPx: number };
  /** Splats that reading must drop, by reason, for cases given as files. */
  readonly dropped?: DropCounts;
  /**
   * Bounds in place of the usual ones, by preset. By default `reference` must reach 55 dB, and
   * others are only reported.
   */
  readonly bounds?: Partial<Record<AccuracyPreset, BoundException>>;
  /** Most workgroups in one dimension of a dispatch; default the device's limit. */
  readonly maxWorkgroupsPerDimension?: number;
  /**
   * Number of frames that must agree in every bit, default 2; cases of ties use 100, and a second
   * device too.
   */
  readonly identicalFrames?: number;
  /**
   * The threshold at which rounding may decide either way. Stages of such a case are checked apart
   * from that decision, and its images are not compared.
   */
  readonly decidesAtThreshold?: string;
}

/** Bytes that are not splats: reading them must fail with this code. */
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

/** A scene on a device with fewer features and limits than possible, checked like a scene case. */
export interface DeviceCase extends Omit<SceneCase, 'kind'> {
  readonly kind: 'device';
  /** Features that are not requested for the device, whose limits are WebGPU's defaults. */
  readonly without: readonly string[];
}

/** Arithmetic on offsets beyond a run's memory: null if it holds, or a description of the flaw. */
export interface ArithmeticCase extends HardCaseBase {
  readonly kind: 'arithmetic';
  readonly check: () => string | null;
}

/** The part of a found camera that is compared. */
export type FirstCamera = Pick<SceneFraming, 'kind' | 'position' | 'target' | 'up'>;

/** A property of a good first camera, independent of the exact coordinates. */
export interface CameraProperty {
  /** Completes “expected that …”. */
  readonly what: string;
  readonly holds: (camera: FirstCamera) => boolean;
}

/**
 * A scene whose first camera `frameScene` must find, with its default options: the same one on every
 * device, bit for bit.
 */
export interface FramingCase extends HardCaseBase {
  readonly kind: 'framing';
  readonly clouds: () => readonly HardCloud[];
  /** Properties that a person expects of the camera; all `cameras` have them. */
  readonly expects: readonly CameraProperty[];
  /** The camera, by how geometry is stored: packing rounds sizes and turns of splats. */
  readonly cameras: Readonly<Record<GeometryPrecision, FirstCamera>>;
}

export type HardCase = SceneCase | RefusedFileCase | SortCase | DeviceCase | FramingCase | ArithmeticCase;
