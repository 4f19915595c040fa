import type { SplatReach } from '../camera/frustum.ts';
import { InvalidArgumentError } from '../errors.ts';
import { type GpuFields, type GpuStruct, type GpuValues, gpuStruct } from '../layout/gpu-struct.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { SplatSelection } from '../splats/splat-selection.ts';

/**
 * Where an effect's shader takes part, by the names of its functions. Each function has the effect's parameters as its last
 * argument, a struct named like the effect (`wind-sway`: `WindSway`), where there are any. Before it, those for splats and
 * colours have `selected: bool`, where the effect takes a selection.
 */
export interface EffectHooks {
  /**
   * `fn name(splat: Splat, splatIndex: u32, …) -> Splat`: changes a splat in its cloud's space, in cull-splats and in
   * project, before anything is made of it. `splatIndex` counts within a page, and is the same from frame to frame.
   */
  readonly splat?: string;
  /**
   * `fn name(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32, …) -> f32`: changes a splat's opacity by what becomes
   * of it on the screen, in cull-splats and in project.
   */
  readonly opacity?: string;
  /**
   * `fn name(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, …) -> vec3f`: changes a splat's colour, in
   * project; sRGB-encoded like what scenes are trained with, before it is clamped.
   */
  readonly color?: string;
}

/** Where a cloud stands in the frame that an effect's uniforms are made for; all in float64. */
export interface EffectPlace {
  /** Cloud to world, column-major. */
  readonly modelMatrix: ArrayLike<number>;
  /** What the shader's positions are relative to, in the cloud's space. */
  readonly origin: Vec3;
  /** World to view, column-major. */
  readonly viewMatrix: ArrayLike<number>;
}

/** One effect: everything that is to be known of it but for what a caller says. */
export interface SplatEffect {
  /** Lower case with hyphens, like the file of its shader. */
  readonly name: string;
  /** What a person would call it. */
  readonly label: string;
  /** What it does: one sentence. */
  readonly about: string;
  readonly hooks: EffectHooks;
  /** Module `package::effects::NAME`, written as shaders/effects are. */
  readonly wgsl: string;
  /** What its functions take last; null where they take nothing more. */
  readonly parameters: GpuStruct<GpuFields> | null;
  /** Whether its functions are told which splats are selected. */
  readonly takesSelection: boolean;
}

/** An effect with what a caller says of it, for one cloud of one frame. Made by the effect's own function: `tint([1, 0, 0])`. */
export interface EffectUse {
  readonly effect: SplatEffect;
  /** As the caller gave them. */
  readonly options: unknown;
  /** Why it takes part at this moment, in words; null where the options change nothing, and it takes no part. */
  readonly reason: string | null;
  readonly reach: SplatReach;
  /** Null where it takes none. */
  readonly selection: SplatSelection | null;
  /** Contents of its parameters; null where it has none. */
  valuesAt(place: EffectPlace): GpuValues<GpuFields> | null;
}

/** What `defineEffect` takes. */
export interface EffectDefinition<Options, Fields extends GpuFields>
  extends Pick<SplatEffect, 'name' | 'label' | 'about' | 'hooks' | 'wgsl'> {
  /** What its functions take last: WGSL types by name; default nothing. */
  readonly fields?: Fields;
  /** Why these options change a picture, in words, or null where they change nothing. */
  readonly calledFor: (options: Options) => string | null;
  /** @throws InvalidArgumentError for options that mean nothing. */
  readonly check?: (options: Options) => void;
  /** Which splats its functions are told are selected; default it takes no selection. */
  readonly selection?: (options: Options) => SplatSelection;
  /** Contents of the fields. */
  readonly valuesAt?: (options: Options, place: EffectPlace) => GpuValues<Fields>;
  /** Default: it moves nothing and nothing grows. */
  readonly reach?: (options: Options) => SplatReach;
}

/** Makes uses of one effect. */
export interface EffectFunction<Options> {
  /** @throws InvalidArgumentError for options that mean nothing. */
  (...options: undefined extends Options ? [options?: Options] : [options: Options]): EffectUse;
  readonly effect: SplatEffect;
}

const NO_REACH: SplatReach = { displacement: 0, growth: 1 };

/**
 * A new effect: a function that makes uses of it for `CloudInstance.effects`. What belongs to an effect is in the shaders only
 * where a cloud of the frame uses it and `calledFor` gives a reason.
 *
 * @throws InvalidArgumentError for a name that is not lower case with hyphens, or an effect without hooks.
 */
export function defineEffect<Options, const Fields extends GpuFields = Record<never, never>>(
  definition: EffectDefinition<Options, Fields>,
): EffectFunction<Options> {
  const { name, label, about, hooks, wgsl, fields, calledFor, check, selection, valuesAt, reach } =
    definition;
  if (!/^[a-z][a-z0-9]*(-[a-z0-9]+)*$/.test(name)) {
    const message = `An effect is named "${name}"; names are lower case with hyphens, like "wind-sway".`;
    throw new InvalidArgumentError('name', message);
  }
  if (Object.keys(hooks).length === 0)
    throw new InvalidArgumentError('hooks', `The effect ${name} has no hooks: it would change nothing.`);
  const parameters = fields ? (gpuStruct(structName(name), fields) as GpuStruct<GpuFields>) : null;
  const takesSelection = selection !== undefined;
  const effect: SplatEffect = { name, label, about, hooks, wgsl, parameters, takesSelection };
  const use = (options: Options): EffectUse => {
    check?.(options);
    return {
      effect,
      options,
      // What is selected changes.
      get reason() {
        return calledFor(options);
      },
      reach: reach?.(options) ?? NO_REACH,
      selection: selection?.(options) ?? null,
      valuesAt: (place) => valuesAt?.(options, place) ?? null,
    };
  };
  return Object.assign(use, { effect }) as EffectFunction<Options>;
}

/** `WindSway` of `wind-sway`. */
function structName(name: string): string {
  return name.replace(/(?:^|-)(.)/g, (_, first: string) => first.toUpperCase());
}
