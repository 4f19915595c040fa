import { InvalidArgumentError } from './errors.ts';
import { HALF_MAX } from './layout/half.ts';
import type { ShPrecision } from './layout/sh-rest.ts';
import type { ShDegree } from './scene/splat-set.ts';

/** How centres, rotations, scales, base colours and opacities are stored: 64 or 32 bytes per splat. */
export type GeometryPrecision = 'f32' | 'packed';

/** Colour and opacity of a projected splat: four float32 or four float16. */
export type RecordPrecision = 'f32' | 'f16';

/** Format of the texture in which splats are blended. */
export type ColorTarget = 'rgba8unorm' | 'rgba16float' | 'rgba32float';

/** Everything that trades accuracy for time or memory. */
export interface AccuracySettings {
  readonly geometryPrecision: GeometryPrecision;
  readonly shPrecision: ShPrecision;
  /** Highest degree of spherical harmonics that is evaluated. */
  readonly shDegree: ShDegree;
  readonly recordPrecision: RecordPrecision;
  readonly colorTarget: ColorTarget;
  /** Opacity under which a splat, or a fragment of one, is left out. */
  readonly alphaCutoff: number;
}

export type AccuracyPreset = 'reference' | 'high' | 'balanced';

/** One setting: what it may be, where it acts and where its values come from. */
export interface AccuracySetting<Value> {
  readonly unit: string;
  /** The values offered, most exact first; for a number, a range. */
  readonly values: readonly Value[] | { readonly min: number; readonly max: number };
  readonly stage: 'load' | 'pre-process' | 'sort' | 'rasterize';
  readonly source: string;
}

/** The one place for every cutoff, precision and cap. */
export const ACCURACY_SETTINGS: {
  readonly [Name in keyof AccuracySettings]: AccuracySetting<AccuracySettings[Name]>;
} = {
  geometryPrecision: {
    unit: 'storage',
    values: ['f32', 'packed'],
    stage: 'load',
    source: 'packed: smallest-three rotation of 3×15 bits, unorm16 log scales over the range of the cloud',
  },
  shPrecision: {
    unit: 'storage',
    values: ['f32', 'f16', 'u8'],
    stage: 'load',
    source: 'u8: one byte per coefficient, scaled per splat by its largest',
  },
  shDegree: {
    unit: 'degree',
    values: [3, 2, 1, 0],
    stage: 'pre-process',
    source: 'scenes are trained up to degree 3',
  },
  recordPrecision: {
    unit: 'storage',
    values: ['f32', 'f16'],
    stage: 'pre-process',
    source: 'float16 colours err by at most 2^-11 of their value',
  },
  colorTarget: {
    unit: 'texture format',
    values: ['rgba32float', 'rgba16float', 'rgba8unorm'],
    stage: 'rasterize',
    source: 'every blended layer is rounded to this format',
  },
  alphaCutoff: {
    unit: 'opacity',
    values: { min: 1 / 4096, max: 0.1 },
    stage: 'pre-process',
    source: '1/255 in the original implementation: less cannot change an 8-bit pixel by itself',
  },
};

/** Settings by preset. Where `float32-blendable` is missing, `reference` blends in rgba16float and says so. */
export const ACCURACY_PRESETS: Readonly<Record<AccuracyPreset, AccuracySettings>> = {
  reference: {
    geometryPrecision: 'f32',
    shPrecision: 'f32',
    shDegree: 3,
    recordPrecision: 'f32',
    colorTarget: 'rgba32float',
    alphaCutoff: 1 / 255,
  },
  high: {
    geometryPrecision: 'f32',
    shPrecision: 'f16',
    shDegree: 3,
    recordPrecision: 'f16',
    colorTarget: 'rgba16float',
    alphaCutoff: 1 / 255,
  },
  balanced: {
    geometryPrecision: 'packed',
    shPrecision: 'u8',
    shDegree: 3,
    recordPrecision: 'f16',
    colorTarget: 'rgba16float',
    alphaCutoff: 1 / 255,
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
  return recordPrecision === 'f32' && colorTarget === 'rgba32float' ? 1e37 : HALF_MAX;
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
