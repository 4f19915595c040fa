import { InvalidArgumentError } from '../errors.ts';
import { HALF_MAX } from '../layout/half.ts';
import type { GeometryPrecision, ShPrecision } from '../packing/precision.ts';
import type { ShDegree } from '../splats/splat-set.ts';

/**
 * What is kept of a projected splat. `f32` and `f16`: axes in float32, colour and opacity in float32 or float16, 48 or 32
 * bytes. `paper`: axes in float16 (none longer than 65504 px), colour and opacity in a byte each, so that colours end at 1;
 * 24 bytes.
 */
export type RecordPrecision = 'f32' | 'f16' | 'paper';

/** Format of the texture in which splats are blended. */
export type ColorTarget = 'rgba8unorm' | 'rgba16float' | 'rgba32float';

/** Most bits that depth keys may differ in. */
export type SortKeyBits = 32 | 24 | 20 | 16;

/** How large a splat's quad is: as far as its own opacity reaches, or as far as that of an opaque one would. */
export type Extent = 'opacity' | 'fixed';

/** Which splats of the chunks in sight are drawn: those whose box reaches into the picture, or all. */
export type Culling = 'bounding-box' | 'frustum';

/** Everything that trades accuracy for time or memory. */
export interface AccuracySettings {
  readonly geometryPrecision: GeometryPrecision;
  readonly shPrecision: ShPrecision;
  /** Highest degree of spherical harmonics that is evaluated. */
  readonly shDegree: ShDegree;
  readonly sortKeyBits: SortKeyBits;
  /** Opacity under which a splat, or a fragment of one, is left out. */
  readonly alphaCutoff: number;
  readonly extent: Extent;
  readonly culling: Culling;
  readonly recordPrecision: RecordPrecision;
  readonly colorTarget: ColorTarget;
  /** Width and height of the layer of splats, as a part of the picture's. */
  readonly resolutionScale: number;
}

/** Settings as a device can have them. */
export interface PossibleAccuracy {
  readonly settings: AccuracySettings;
  /** What the device could not do as asked, in words. */
  readonly notices: readonly string[];
}

export type AccuracyPreset = 'reference' | 'high' | 'balanced' | 'fast' | 'paper';

/** One setting: what it may be, where it acts, what it costs to change, and where its values come from. */
export interface AccuracySetting<Value> {
  /** What a person would call it. */
  readonly label: string;
  /** What it does: one sentence. */
  readonly about: string;
  readonly unit: string;
  /** The values offered, most exact first (of those that err alike the fastest first); for a number, a range. */
  readonly values: readonly Value[] | { readonly min: number; readonly max: number };
  /** The stage that it acts on. */
  readonly stage: 'load' | 'pre-process' | 'sort' | 'rasterize' | 'composite';
  /** What changing it takes while the engine runs: a number, other shaders (compiled once), or other data on the GPU. */
  readonly change: 'uniform' | 'shader' | 'plane';
  readonly source: string;
}

/** The one place for every cutoff, precision and cap. */
export const ACCURACY_SETTINGS: {
  readonly [Name in keyof AccuracySettings]: AccuracySetting<AccuracySettings[Name]>;
} = {
  geometryPrecision: {
    label: 'Geometry',
    about: 'How exactly rotations, scales, base colours and opacities are stored: 64 or 32 bytes per splat.',
    unit: 'storage',
    values: ['f32', 'packed'],
    stage: 'load',
    change: 'plane',
    source: 'packed: smallest-three rotation of 3×15 bits, unorm16 log scales over the range of the cloud',
  },
  shPrecision: {
    label: 'Harmonics',
    about: 'How exactly the coefficients are stored that make a colour depend on where it is seen from.',
    unit: 'storage',
    values: ['f32', 'f16', 'u8'],
    stage: 'load',
    change: 'plane',
    source: 'u8: one byte per coefficient, scaled per splat by its largest',
  },
  shDegree: {
    label: 'Harmonics degree',
    about: 'Up to which degree colours depend on where they are seen from; at 0 they do not.',
    unit: 'degree',
    values: [3, 2, 1, 0],
    stage: 'pre-process',
    change: 'shader',
    source: 'scenes are trained up to degree 3',
  },
  sortKeyBits: {
    label: 'Sort keys',
    about: 'How finely depths are told apart when splats are sorted; fewer bits take fewer passes.',
    unit: 'bits',
    values: [32, 24, 20, 16],
    stage: 'sort',
    change: 'shader',
    source:
      'the top bits of the range of depths in sight; 32 is exact, and what is equal stays in storage order',
  },
  alphaCutoff: {
    label: 'Opacity cutoff',
    about:
      'The opacity under which a splat, or a part of one, is left out; a higher one makes splats smaller.',
    unit: 'opacity',
    values: { min: 1 / 4096, max: 0.1 },
    stage: 'pre-process',
    change: 'uniform',
    source: '1/255 in the original implementation: less cannot change an 8-bit pixel by itself',
  },
  extent: {
    label: 'Quad size',
    about: 'Whether faint splats are drawn as smaller quads; the picture is the same.',
    unit: 'method',
    values: ['opacity', 'fixed'],
    stage: 'rasterize',
    change: 'shader',
    source: 'the paper, √ln(opacity/cutoff); fixed is its ablation −RADIUS',
  },
  culling: {
    label: 'Culling',
    about:
      'Whether each splat is tested against the picture or only each chunk of 256; the picture is the same.',
    unit: 'method',
    values: ['bounding-box', 'frustum'],
    stage: 'pre-process',
    change: 'shader',
    source: 'the paper, screen-space bounding boxes; frustum is its ablation −CULL',
  },
  recordPrecision: {
    label: 'Projected splats',
    about:
      'How exactly axes, colour and opacity of a splat on the screen are kept between projecting and drawing it.',
    unit: 'storage',
    values: ['f32', 'f16', 'paper'],
    stage: 'pre-process',
    change: 'shader',
    source: 'f16: colours err by at most 2^-11 of their value; paper: float16 axes, 8-bit colour and opacity',
  },
  colorTarget: {
    label: 'Blending',
    about: 'The format that every blended layer is rounded to.',
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
    values: { min: 0.25, max: 1 },
    stage: 'composite',
    change: 'shader',
    source: 'bilinear; what is in front of splats keeps its full resolution',
  },
};

/** Settings by preset. Where `float32-blendable` is missing, `reference` blends in rgba16float and says so. */
export const ACCURACY_PRESETS: Readonly<Record<AccuracyPreset, AccuracySettings>> = {
  /** The most exact that the GPU can do. */
  reference: {
    geometryPrecision: 'f32',
    shPrecision: 'f32',
    shDegree: 3,
    sortKeyBits: 32,
    alphaCutoff: 1 / 255,
    extent: 'opacity',
    culling: 'bounding-box',
    recordPrecision: 'f32',
    colorTarget: 'rgba32float',
    resolutionScale: 1,
  },
  high: {
    geometryPrecision: 'f32',
    shPrecision: 'f16',
    shDegree: 3,
    sortKeyBits: 32,
    alphaCutoff: 1 / 255,
    extent: 'opacity',
    culling: 'bounding-box',
    recordPrecision: 'f16',
    colorTarget: 'rgba16float',
    resolutionScale: 1,
  },
  balanced: {
    geometryPrecision: 'packed',
    shPrecision: 'u8',
    shDegree: 3,
    sortKeyBits: 32,
    alphaCutoff: 1 / 255,
    extent: 'opacity',
    culling: 'bounding-box',
    recordPrecision: 'f16',
    colorTarget: 'rgba16float',
    resolutionScale: 1,
  },
  /**
   * What saves most for what it shows, by measurement (docs/accuracy.md): half the bytes of every blended layer, smaller
   * quads, and keys so short that most splats are drawn in the order that they are stored in. Harmonics keep their degree,
   * which costs next to nothing and shows more than all of this.
   */
  fast: {
    geometryPrecision: 'packed',
    shPrecision: 'u8',
    shDegree: 3,
    sortKeyBits: 16,
    alphaCutoff: 1 / 128,
    extent: 'opacity',
    culling: 'bounding-box',
    recordPrecision: 'f16',
    colorTarget: 'rgba8unorm',
    resolutionScale: 1,
  },
  /**
   * The precision of the paper: scenes as trained, float16 axes, 8-bit colours and opacities, keys of 32 bits. Of the passes
   * that it sorts them in, those are left out in which all keys are known to agree: the order is the same.
   */
  paper: {
    geometryPrecision: 'f32',
    shPrecision: 'f32',
    shDegree: 3,
    sortKeyBits: 32,
    alphaCutoff: 1 / 255,
    extent: 'opacity',
    culling: 'bounding-box',
    recordPrecision: 'paper',
    colorTarget: 'rgba8unorm',
    resolutionScale: 1,
  },
};

export const DEFAULT_ACCURACY: AccuracyPreset = 'balanced';

/** A preset, or settings that differ from one (from `balanced` where it is not named). */
export type Accuracy = AccuracyPreset | ({ readonly preset?: AccuracyPreset } & Partial<AccuracySettings>);

/**
 * The settings that `accuracy` stands for.
 *
 * @throws InvalidArgumentError naming the preset or setting, what was found and what may stand there.
 */
export function resolveAccuracy(accuracy: Accuracy = DEFAULT_ACCURACY): AccuracySettings {
  const { preset = DEFAULT_ACCURACY, ...changes } =
    typeof accuracy === 'string' ? { preset: accuracy } : accuracy;
  if (!Object.hasOwn(ACCURACY_PRESETS, preset)) {
    const names = Object.keys(ACCURACY_PRESETS).join(', ');
    throw new InvalidArgumentError(
      'accuracy',
      `There is no accuracy preset "${preset}"; there are ${names}.`,
    );
  }
  for (const [name, value] of Object.entries(changes)) checkSetting(name, value);
  return { ...ACCURACY_PRESETS[preset], ...changes };
}

const resolved = new WeakMap<object, AccuracySettings>();
const interned = new Map<string, AccuracySettings>();

/**
 * What `resolveAccuracy` returns, as one frozen object for all that stand for the same settings: equal settings are
 * identical. An object is looked at once; changing it later changes nothing.
 *
 * @throws InvalidArgumentError as `resolveAccuracy` does.
 */
export function internAccuracy(accuracy: Accuracy = DEFAULT_ACCURACY): AccuracySettings {
  const known = typeof accuracy === 'object' ? resolved.get(accuracy) : interned.get(accuracy);
  if (known) return known;
  const settings = resolveAccuracy(accuracy);
  // Every object has the presets' order of names: that of the caller's own makes no difference.
  const key = JSON.stringify(settings);
  const one = interned.get(key) ?? Object.freeze(settings);
  interned.set(key, one);
  if (typeof accuracy === 'object') resolved.set(accuracy, one);
  else interned.set(accuracy, one);
  resolved.set(one, one);
  return one;
}

/** Fixed by how scenes are trained, or by the method, not by taste. */
export const MAX_FRAGMENT_ALPHA = 0.99;
/** Variance that is added to both screen axes, in px²: what scenes are trained with. */
export const DILATION_PX2 = 0.3;

/**
 * Largest colour that is blended: what the record and the target hold, since an infinity turns into NaN under the next
 * splat. In float32 1e37, which sixteen terms of spherical harmonics cannot exceed by much.
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

/** Size of the layer that splats are blended in for a picture of this size: at least a pixel each way. */
export function layerSize(
  { widthPx, heightPx }: SizePx,
  { resolutionScale }: Pick<AccuracySettings, 'resolutionScale'>,
): SizePx {
  // No less than a pixel of what has any.
  const scaled = (px: number) => Math.min(px, Math.max(1, Math.round(resolutionScale * px)));
  return { widthPx: scaled(widthPx), heightPx: scaled(heightPx) };
}

function checkSetting(name: string, value: unknown): void {
  const setting = (ACCURACY_SETTINGS as Record<string, AccuracySetting<unknown>>)[name];
  if (!Object.hasOwn(ACCURACY_SETTINGS, name)) {
    const names = Object.keys(ACCURACY_SETTINGS).join(', ');
    throw new InvalidArgumentError(name, `There is no accuracy setting "${name}"; there are ${names}.`);
  }
  const { values } = setting;
  if ('min' in values) {
    if (typeof value === 'number' && value >= values.min && value <= values.max) return;
    throw new InvalidArgumentError(
      name,
      `${name} is ${value}; it must lie in ${values.min}…${values.max} (${setting.unit}).`,
    );
  }
  if (!values.includes(value)) {
    throw new InvalidArgumentError(name, `${name} is ${value}; it must be one of ${values.join(', ')}.`);
  }
}
