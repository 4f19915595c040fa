import { InvalidArgumentError } from '../errors.ts';
import { wrongArgument } from '../given.ts';
import { HALF_MAX } from '../layout/half.ts';
import {
  GEOMETRY_PRECISIONS,
  type GeometryPrecision,
  type RowPrecision,
  SH_PRECISIONS,
  type ShPrecision,
} from '../packing/precision.ts';
import { shown } from '../printable.ts';

/**
 * Precision of a record. `f32` and `f16`: axes in float32, colour and opacity in float32 or
 * float16, 48 or 32 bytes. `paper`: axes in float16 (none longer than 65504 px), colour channels
 * and opacity in one byte each, so that colours end at 1; 24 bytes.
 */
export type RecordPrecision = 'f32' | 'f16' | 'paper';

/** Format of the texture in which splats are blended. */
export type ColorTarget = 'rgba8unorm' | 'rgba16float' | 'rgba32float';

/** Significant bits of depth keys: above 32 keys are float64 depths, else float32 depths. */
export type SortKeyBits = 64 | 32 | 24 | 16;

/** Size of a splat's quad: up to the alpha cutoff at its own opacity, or as if it were opaque. */
export type Extent = 'opacity' | 'fixed';

/**
 * Splats drawn of visible chunks. `bounding-box`: splats whose bounding box reaches into the image;
 * `frustum`: all.
 */
export type Culling = 'bounding-box' | 'frustum';

/**
 * Rasteriser of the splats: tiles blend them in compute shaders, front to back in float32; quads
 * use the GPU's own rasteriser and blending, back to front, in the format of the layer. `auto`
 * takes the faster of both.
 */
export type Rasterizer = FrameRasterizer | 'auto';

/** Rasteriser of one frame. */
export type FrameRasterizer = 'tiles' | 'quads';

/** All settings that trade accuracy for time or memory. */
export interface AccuracySettings {
  readonly geometryPrecision: GeometryPrecision;
  readonly shPrecision: ShPrecision;
  readonly sortKeyBits: SortKeyBits;
  /** Opacity below which a splat, or a fragment of one, is not drawn. */
  readonly alphaCutoff: number;
  readonly extent: Extent;
  readonly culling: Culling;
  readonly recordPrecision: RecordPrecision;
  readonly rasterizer: Rasterizer;
  readonly colorTarget: ColorTarget;
  /** Width and height of the layer of splats, as a fraction of the image's. */
  readonly resolutionScale: number;
}

/** Settings that a device supports. */
export interface PossibleAccuracy {
  readonly settings: AccuracySettings;
  /** Sentences on the settings that the device does not support, and their replacements. */
  readonly notices: readonly string[];
}

/** Name of a preset, from the most exact to the fastest; `paper` is the precision of the paper. */
export type AccuracyPreset = 'reference' | 'high' | 'balanced' | 'fast' | 'paper';

/** One setting: its values and their origin, the stage it acts on, the cost of a change. */
export interface AccuracySetting<Value> {
  /** Human-readable name. */
  readonly label: string;
  /** The setting's effect, in one sentence. */
  readonly about: string;
  readonly unit: string;
  /** Possible values, most exact first (then the fastest first); for a number, a range. */
  readonly values: readonly Value[] | { readonly min: number; readonly max: number };
  /** The stage that the setting acts on. */
  readonly stage: 'load' | 'pre-process' | 'sort' | 'rasterize' | 'composite';
  /** A change takes a number, other shaders (compiled once), or other data on the GPU. */
  readonly change: 'uniform' | 'shader' | 'plane';
  readonly source: string;
}

/** The least `resolutionScale`. */
export const LEAST_RESOLUTION_SCALE = 0.25;

/** The single definition of every cutoff, precision and cap. */
export const ACCURACY_SETTINGS: {
  readonly [Name in keyof AccuracySettings]: AccuracySetting<AccuracySettings[Name]>;
} = {
  geometryPrecision: {
    label: 'Geometry',
    about: 'Precision of stored rotations, scales, base colours and opacities: 64 or 32 bytes per splat.',
    unit: 'storage',
    values: GEOMETRY_PRECISIONS,
    stage: 'load',
    change: 'plane',
    source: 'packed: smallest-three rotation of 3×15 bits, unorm16 log scales over the range of each chunk',
  },
  shPrecision: {
    label: 'Harmonics',
    about:
      'Precision of the stored coefficients that make colours depend on the view; the palette that a file may have takes the fewest bytes.',
    unit: 'storage',
    values: SH_PRECISIONS,
    stage: 'load',
    change: 'plane',
    source: 'u8: one byte per coefficient, scaled per splat by the largest one; palette: two bytes per splat',
  },
  sortKeyBits: {
    label: 'Sort keys',
    about: 'Bits of depth that splats are sorted by; fewer bits take fewer passes.',
    unit: 'bits',
    values: [64, 32, 24, 16],
    stage: 'sort',
    change: 'shader',
    source:
      '64: depths as float64 has them; 32: as float32 does; fewer: the top bits of their range; equal keys stay in storage order',
  },
  alphaCutoff: {
    label: 'Opacity cutoff',
    about:
      'Opacity below which splats, or parts of them, are not drawn; a higher cutoff makes splats smaller.',
    unit: 'opacity',
    values: { min: 1 / 4096, max: 0.1 },
    stage: 'pre-process',
    change: 'uniform',
    source: '1/255 in the original implementation: less cannot change an 8-bit pixel on its own',
  },
  extent: {
    label: 'Quad size',
    about: 'Whether faint splats are drawn as smaller quads; the image is the same.',
    unit: 'method',
    values: ['opacity', 'fixed'],
    stage: 'rasterize',
    change: 'shader',
    source: 'the paper, √ln(opacity/cutoff); fixed is its ablation −RADIUS',
  },
  culling: {
    label: 'Culling',
    about: 'Whether each splat is tested against the view or only each chunk of 256; the image is the same.',
    unit: 'method',
    values: ['bounding-box', 'frustum'],
    stage: 'pre-process',
    change: 'shader',
    source: 'the paper, screen-space bounding boxes; frustum is its ablation −CULL',
  },
  recordPrecision: {
    label: 'Splat records',
    about: 'Precision of a splat’s axes, colour and opacity between projecting and drawing it.',
    unit: 'storage',
    values: ['f32', 'f16', 'paper'],
    stage: 'pre-process',
    change: 'shader',
    source: 'f16: colours err by at most 2^-11 of their value; paper: float16 axes, 8-bit colour and opacity',
  },
  rasterizer: {
    label: 'Rasteriser',
    about: 'Whether compute shaders blend tiles of the image in float32, or the GPU blends a quad per splat.',
    unit: 'method',
    values: ['tiles', 'auto', 'quads'],
    stage: 'rasterize',
    change: 'shader',
    source: 'the paper draws quads; auto measures both on this device',
  },
  colorTarget: {
    label: 'Blending',
    about: 'Format that every blended layer is rounded to.',
    unit: 'texture format',
    values: ['rgba32float', 'rgba16float', 'rgba8unorm'],
    stage: 'rasterize',
    change: 'shader',
    source:
      'rgba8unorm loses about 15 dB where hundreds of faint layers add up; rgba32float needs float32-blendable',
  },
  resolutionScale: {
    label: 'Resolution',
    about: 'Draws splats smaller by this factor in width and height, and enlarges them smoothly.',
    unit: 'part of the width and height',
    values: { min: LEAST_RESOLUTION_SCALE, max: 1 },
    stage: 'composite',
    change: 'shader',
    source: 'bilinear; objects in front of splats keep their full resolution',
  },
};

/** Settings by preset. Without `float32-blendable`, `reference` blends in rgba16float. */
export const ACCURACY_PRESETS: Readonly<Record<AccuracyPreset, AccuracySettings & RowPrecision>> = {
  /** The most exact settings that the GPU supports. */
  reference: {
    geometryPrecision: 'f32',
    shPrecision: 'f32',
    sortKeyBits: 64,
    alphaCutoff: 1 / 255,
    extent: 'opacity',
    culling: 'bounding-box',
    recordPrecision: 'f32',
    rasterizer: 'auto',
    colorTarget: 'rgba32float',
    resolutionScale: 1,
  },
  high: {
    geometryPrecision: 'f32',
    shPrecision: 'f16',
    sortKeyBits: 32,
    alphaCutoff: 1 / 255,
    extent: 'opacity',
    culling: 'bounding-box',
    recordPrecision: 'f16',
    rasterizer: 'auto',
    colorTarget: 'rgba16float',
    resolutionScale: 1,
  },
  balanced: {
    geometryPrecision: 'packed',
    shPrecision: 'u8',
    sortKeyBits: 32,
    alphaCutoff: 1 / 255,
    extent: 'opacity',
    culling: 'bounding-box',
    recordPrecision: 'f16',
    rasterizer: 'auto',
    colorTarget: 'rgba16float',
    resolutionScale: 1,
  },
  /**
   * The largest measured savings for the least visible error (docs/accuracy.md): half the bytes of
   * every blended layer, smaller quads, and keys so short that many splats share one, and are drawn in
   * storage order among themselves.
   */
  fast: {
    geometryPrecision: 'packed',
    shPrecision: 'u8',
    sortKeyBits: 16,
    alphaCutoff: 1 / 128,
    extent: 'opacity',
    culling: 'bounding-box',
    recordPrecision: 'f16',
    rasterizer: 'auto',
    colorTarget: 'rgba8unorm',
    resolutionScale: 1,
  },
  /**
   * The precision of the paper: scenes as trained, float16 axes, 8-bit colours and opacities, keys
   * of 32 bits. Sort passes over bits that all keys are known to share are skipped; the order is
   * the same.
   */
  paper: {
    geometryPrecision: 'f32',
    shPrecision: 'f32',
    sortKeyBits: 32,
    alphaCutoff: 1 / 255,
    extent: 'opacity',
    culling: 'bounding-box',
    recordPrecision: 'paper',
    rasterizer: 'quads',
    colorTarget: 'rgba8unorm',
    resolutionScale: 1,
  },
};

/** The preset of an engine that is asked for none. */
export const DEFAULT_ACCURACY: AccuracyPreset = 'balanced';

/** A preset, or settings that differ from one (from `balanced` if none is named). */
export type Accuracy = AccuracyPreset | ({ readonly preset?: AccuracyPreset } & Partial<AccuracySettings>);

/**
 * Returns the settings that `accuracy` stands for.
 *
 * @throws InvalidArgumentError naming the preset or setting, the value found and the valid ones.
 * @example
 * const { geometryPrecision, alphaCutoff } = resolveAccuracy({ preset: 'high', sortKeyBits: 24 });
 */
export function resolveAccuracy(accuracy: Accuracy = DEFAULT_ACCURACY): AccuracySettings {
  if (typeof accuracy !== 'string' && Object.prototype.toString.call(accuracy) !== '[object Object]') {
    throw new InvalidArgumentError(
      'accuracy',
      `The accuracy is ${shown(accuracy)}; it must be the name of a preset, or an object of settings.`,
    );
  }
  const { preset = DEFAULT_ACCURACY, ...changes } =
    typeof accuracy === 'string' ? { preset: accuracy } : accuracy;
  if (typeof preset !== 'string' || !Object.hasOwn(ACCURACY_PRESETS, preset)) {
    const names = Object.keys(ACCURACY_PRESETS).join(', ');
    throw new InvalidArgumentError(
      'accuracy',
      `There is no accuracy preset "${shown(preset)}"; there are ${names}.`,
    );
  }
  for (const [name, value] of Object.entries(changes)) checkSetting(name, value);
  return { ...ACCURACY_PRESETS[preset], ...changes };
}

const resolved = new WeakMap<object, AccuracySettings>();
const interned = new Map<string, AccuracySettings>();

/**
 * Returns the result of `resolveAccuracy` as a frozen object; equal settings are the same object.
 * An object is read once; changing it later changes nothing.
 *
 * @throws InvalidArgumentError as `resolveAccuracy` does.
 */
export function internAccuracy(accuracy: Accuracy = DEFAULT_ACCURACY): AccuracySettings {
  const known = typeof accuracy === 'object' ? resolved.get(accuracy) : interned.get(accuracy);
  if (known) return known;
  const settings = resolveAccuracy(accuracy);
  // `resolveAccuracy` orders the settings' names as in the presets, so equal settings have equal keys.
  const key = JSON.stringify(settings);
  const one = interned.get(key) ?? Object.freeze(settings);
  interned.set(key, one);
  if (typeof accuracy === 'object') resolved.set(accuracy, one);
  else interned.set(accuracy, one);
  resolved.set(one, one);
  return one;
}

/** Largest opacity of a fragment. Fixed by training or the method, like DILATION_PX2. */
export const MAX_FRAGMENT_ALPHA = 0.99;
/**
 * Variance added to both screen axes, px², unless the effect `antialias` sets another; scenes are
 * trained with this value.
 */
export const DILATION_PX2 = 0.3;
/**
 * The same, px², where `antialias` is on for a scene that was not trained with it: about the variance
 * of a pixel's box, 1/12. 0.3 blurs twice as far, and 0.05 leaves stairs.
 */
export const ANTIALIAS_DILATION_PX2 = 0.1;

/**
 * Returns the largest colour that is blended: the largest that both record and target hold, since
 * an infinity turns into NaN under the next splat. In float32 it is 1e37, which sixteen terms of
 * spherical harmonics cannot exceed by much.
 */
export function maxColor({ recordPrecision, colorTarget }: AccuracySettings): number {
  if (recordPrecision === 'paper') return 1;
  return recordPrecision === 'f32' && colorTarget === 'rgba32float' ? 1e37 : HALF_MAX;
}

/** Width and height, px. */
export interface SizePx {
  readonly widthPx: number;
  readonly heightPx: number;
}

/** Size of the splats' layer for an image of this size: at least 1 px each way. */
export function layerSize(
  { widthPx, heightPx }: SizePx,
  { resolutionScale }: Pick<AccuracySettings, 'resolutionScale'>,
): SizePx {
  // At least one pixel, unless the image itself has none.
  const scaled = (px: number) => Math.min(px, Math.max(1, Math.round(resolutionScale * px)));
  return { widthPx: scaled(widthPx), heightPx: scaled(heightPx) };
}

function checkSetting(name: string, value: unknown): void {
  const setting = (ACCURACY_SETTINGS as Record<string, AccuracySetting<unknown>>)[name];
  if (!Object.hasOwn(ACCURACY_SETTINGS, name)) {
    const names = Object.keys(ACCURACY_SETTINGS).join(', ');
    throw new InvalidArgumentError(
      name,
      `There is no accuracy setting "${shown(name)}"; there are ${names}.`,
    );
  }
  const { values } = setting;
  if ('min' in values) {
    if (typeof value === 'number' && value >= values.min && value <= values.max) return;
    throw new InvalidArgumentError(
      name,
      `${name} is ${shown(value)}; it must lie in ${values.min}…${values.max} (${setting.unit}).`,
    );
  }
  if (!values.includes(value)) {
    throw wrongArgument(name, value, `one of ${values.join(', ')}`);
  }
}
