import type { Projection } from '../../data/camera/camera.ts';
import type { SplatReach } from '../../data/camera/frustum.ts';
import { type GpuFields, type GpuStruct, type GpuValues, gpuStruct } from '../../data/layout/gpu-struct.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import type { SplatSelection } from '../../data/splats/splat-selection.ts';
import type { GpuMemory } from '../gpu-memory.ts';

/**
 * Names of the functions in an effect's shader, by the place where they act. The last argument of
 * each function is the effect's parameters, if it has any: a struct named like the effect
 * (`wind-sway`: `WindSway`). If the effect takes a selection, functions for splats and colours take
 * `selected: bool` before it; if it takes levels, the one for colours takes `level: u32` before that;
 * if it takes rows, functions for splats and colours take `row: u32` before all of these.
 */
export interface EffectHooks {
  /**
   * `fn name(splat: Splat, splatIndex: u32, …) -> Splat`: changes a splat in its cloud's space, in
   * cull-splats and in project, before they use it. `splatIndex` counts within a page, and is the
   * same in every frame; `row` is the splat's row in its file.
   */
  readonly splat?: string;
  /**
   * `fn name(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32, …) -> f32`: changes a splat's
   * opacity depending on its shape on the screen, in cull-splats and in project.
   */
  readonly opacity?: string;
  /**
   * `fn name(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, …) -> vec3f`: changes
   * a splat's colour, in project, before it is clamped: it may be below 0 and above 1; sRGB-encoded,
   * like the images that scenes are trained with.
   */
  readonly color?: string;
  /**
   * @internal `fn name(onScreen: ScreenSplat, …) -> ScreenSplat`: changes a splat's covariance on the
   *   screen, in cull-splats and in project, after all changes of its opacity.
   */
  readonly screen?: string;
  /**
   * @internal `fn name(bounds: ChunkBounds, chunkIndex: u32, …) -> ChunkBounds`: moves the bounds of a
   *   chunk's centres, in cull-chunks; effects of callers state their `reach` instead.
   */
  readonly bounds?: string;
}

/** Place of a cloud in the frame that an effect's uniforms are computed for; all in float64. */
export interface EffectPlace {
  /** Cloud to world, column-major. */
  readonly modelMatrix: ArrayLike<number>;
  /** Origin of the shader's positions, in the cloud's space. */
  readonly origin: Vec3;
  /** World to view, column-major. */
  readonly viewMatrix: ArrayLike<number>;
  /** From view space to the pixels of the frame. */
  readonly projection: Pick<Projection, 'isOrthographic' | 'focalPx'>;
}

/** Textures and storage buffers that an effect's functions read; made by `effectResources`. */
export interface EffectResources<in Options> {
  /** Number of textures. */
  readonly textures: number;
  readonly storageBuffers: number;
  /** @internal The resources in the options of a use, by the effect's own names. */
  readonly of: (options: Options) => Readonly<Record<string, unknown>>;
  /** @internal WGSL declarations for the effect of this name, each but for its binding. */
  declarations(effect: string): readonly string[];
  /**
   * @internal The resources of a use by the names in those declarations.
   *
   * @param acting all uses of the cloud.
   * @throws InvalidArgumentError for unfit resources, or more than a stage of the device may read.
   */
  on(use: EffectUse, acting: readonly EffectUse[], cloud: BoundCloud): readonly BoundResource[];
  /** @internal Why the device has refused one of these resources, as far as it has answered; null if none. */
  refusal(bound: readonly BoundResource[], device: GPUDevice): Error | null;
  /** @internal Asks the device again whether it takes them. Resolves when `refusal` has its answer. */
  ask(use: EffectUse, bound: readonly BoundResource[], device: GPUDevice): Promise<void>;
}

/** @hidden A cloud whose effects read resources. */
export interface BoundCloud {
  readonly name: string;
  readonly device: GPUDevice;
  /** Null if it stands still. */
  readonly timeRange: readonly number[] | null;
}

/** @hidden A resource as stages bind it. */
export interface BoundResource {
  /** Name in WGSL. */
  readonly name: string;
  readonly binding: GPUBuffer | GPUTextureView | GPUSampler;
  /** Changes with the contents; undefined if they may change before each frame. */
  readonly version: number | undefined;
}

/** Gives an effect's functions the row of each splat: `splatRows`. */
export interface EffectRows {
  /** Returns the WGSL of the function that finds a splat's row, with its binding. */
  wgsl(): string;
  /** @internal */
  texturesIn(memory: GpuMemory, queue: GPUQueue): RowTextures;
}

/** @hidden A page of a frame. */
export interface RowPage {
  readonly cloudIndex: number;
  readonly geometry: GPUBuffer;
  readonly isBlobs: boolean;
  readonly splatStart: number;
  readonly splatCount: number;
}

/** @hidden A cloud of a frame. */
export interface RowCloud {
  readonly cloud: {
    readonly fileIndices: Uint32Array;
    readonly version: number;
    readonly pool: object | null;
  };
  readonly effects: { readonly linked: readonly { readonly effect: SplatEffect }[] };
}

/** @hidden Rows of the splats of a frame's pages, on the GPU. */
export interface RowTextures {
  /** Makes room for the clouds whose effects take rows, and frees the rest. */
  fit(clouds: readonly RowCloud[], pages: readonly RowPage[]): void;
  /** Returns the bindings of a page's stages; none if its effects take no rows. */
  bindingsOf(pageIndex: number): { readonly splatRows: GPUTextureView } | null;
  /** Bytes of the rows of one cloud. */
  bytesOf(cloudIndex: number): number;
  /** Writes the rows that have changed since the last frame. */
  write(): void;
}

/** An effect without the options of a particular use. */
export interface SplatEffect {
  /** Lower case with hyphens, like its folder and its shader. */
  readonly name: string;
  /** Human-readable name. */
  readonly label: string;
  /** Description of the effect: one sentence. */
  readonly about: string;
  readonly hooks: EffectHooks;
  /** WGSL of the module `package::effects::NAME`; see the files of this package's effects. */
  readonly wgsl: string;
  /** Struct that the functions take as their last argument; null without parameters. */
  readonly parameters: GpuStruct<GpuFields> | null;
  /** Whether the functions take `selected`. */
  readonly takesSelection: boolean;
  /** Whether the function for colours takes `level`. */
  readonly takesLevel: boolean;
  /** Whether the functions read a list of vec4f, whose length depends on the options. */
  readonly hasList: boolean;
  /** Textures and buffers that the functions read; null without any. */
  readonly resources: EffectResources<never> | null;
  /** Gives the functions for splats and colours `row`; null if they do not take it. */
  readonly rows: EffectRows | null;
}

/** An effect with options, for one cloud of one frame; made by its function: `tint([1, 0, 0])`. */
export interface EffectUse {
  readonly effect: SplatEffect;
  /** Options that the caller passed. */
  readonly options: unknown;
  /** Clause that says why the effect is on; null if its options change nothing: it is off then. */
  readonly reason: string | null;
  /** Those of the effect's hooks that these options need; shaders contain no others. */
  readonly hooks: EffectHooks;
  /** Number of vec4f in the effect's list; 0 without one. */
  readonly listLength: number;
  readonly reach: SplatReach;
  /** Null if the effect takes no selection. */
  readonly selection: SplatSelection | null;
  /** Returns one use that does what this and then `later`, of the same effect, do; null if none can. */
  readonly joined: ((later: EffectUse) => EffectUse) | null;
  /** Returns the contents of the effect's parameters, or of its `list`; null if it has neither. */
  valuesAt(place: EffectPlace): GpuValues<GpuFields> | null;
}

/** Argument of `defineEffect`. */
export interface EffectDefinition<Options, Fields extends GpuFields>
  extends Pick<SplatEffect, 'name' | 'label' | 'about' | 'hooks' | 'wgsl'> {
  /** Fields of the struct that functions take last: WGSL types by name; default none. */
  readonly fields?: Fields;
  /**
   * Returns why these options change the picture, as a part of a sentence for the list of effects, for
   * example `a box hides splats`; null if they change nothing.
   */
  readonly calledFor: (options: Options) => string | null;
  /** Returns the names of the hooks that these options need; default: all of `hooks`. */
  readonly hooksFor?: (options: Options) => readonly (keyof EffectHooks)[];
  /**
   * A list of vec4f in place of `fields`. Functions take no parameters then; they import
   * `parameters::NAMEAt`, which returns the vec4f at an index, without copies of the list.
   */
  readonly list?: {
    /** Returns the number of vec4f. Shaders have room for the next power of two. */
    readonly length: (options: Options) => number;
    /** Returns the numbers, four for each vec4f. */
    readonly at: (options: Options, place: EffectPlace) => ArrayLike<number>;
    /** Returns options that do what `earlier` and then `later` do; default: a cloud takes one list. */
    readonly joined?: (earlier: Options, later: Options) => Options;
  };
  /** Textures and storage buffers of yours that the functions read: see `effectResources`. */
  readonly resources?: EffectResources<Options>;
  /** @throws InvalidArgumentError for invalid options. */
  readonly check?: (options: Options) => void;
  /**
   * Whether the function for colours takes `level: u32`, the level of detail; default false. 0: a
   * splat. n: a blob that merges up to 256·16ⁿ⁻¹ splats, or a splat of level n of a streamed SOG.
   * 15: a coarser splat or blob in place of detail that a view needs and is not on the GPU yet.
   */
  readonly takesLevel?: boolean;
  /**
   * `splatRows` if the functions for splats and colours take `row: u32`, the row of the splat in its
   * cloud's file; default: they do not.
   */
  readonly rows?: EffectRows;
  /** Returns the selection that the functions use; default none. */
  readonly selection?: (options: Options) => SplatSelection;
  /** Returns the contents of the fields. */
  readonly valuesAt?: (options: Options, place: EffectPlace) => GpuValues<Fields>;
  /** Returns how far splats move and how much they grow; default: they do neither. */
  readonly reach?: (options: Options) => SplatReach;
}

/** Makes uses of one effect. */
export interface EffectFunction<Options> {
  /** @throws InvalidArgumentError for invalid options. */
  (...options: undefined extends Options ? [options?: Options] : [options: Options]): EffectUse;
  readonly effect: SplatEffect;
}

/** Of effects that neither move splats nor enlarge them. */
export const NO_REACH: SplatReach = { displacement: 0, growth: 1 };

/** Returns the function that makes uses of an effect. Definitions of callers go through `defineEffect`, which checks them. */
export function effectFunction<Options, const Fields extends GpuFields = Record<never, never>>(
  definition: EffectDefinition<Options, Fields>,
): EffectFunction<Options> {
  const { name, label, about, hooks, wgsl, fields, calledFor, check, selection, valuesAt, reach } =
    definition;
  const { takesLevel = false, hooksFor, list, resources = null, rows = null } = definition;
  const parameters = fields ? gpuStruct(structName(name), fields) : null;
  const takesSelection = selection !== undefined;
  const facts = { parameters, takesSelection, takesLevel, hasList: list !== undefined, resources, rows };
  const effect: SplatEffect = { name, label, about, hooks, wgsl, ...facts };
  const use = (options: Options): EffectUse => {
    check?.(options);
    return {
      effect,
      options,
      // A getter, because the selection may change.
      get reason() {
        return calledFor(options);
      },
      hooks: hooksFor
        ? Object.fromEntries(hooksFor(options).map((hook) => [hook, hooks[hook] as string]))
        : hooks,
      listLength: list?.length(options) ?? 0,
      reach: reach?.(options) ?? NO_REACH,
      selection: selection?.(options) ?? null,
      joined: list?.joined ? (later) => use(list.joined!(options, later.options as Options)) : null,
      valuesAt(place) {
        if (list) return { list: list.at(options, place) };
        return parameters ? valuesAt!(options, place) : null;
      },
    };
  };
  return Object.assign(use, { effect }) as EffectFunction<Options>;
}

/** Returns `WindSway` for `wind-sway`. */
export function structName(name: string): string {
  return name.replace(/(?:^|-)(.)/g, (_, first: string) => first.toUpperCase());
}

/** Numbers and vectors of an effect's list by name, in the order in which its shader reads them. */
export type NamedNumbers = Readonly<Record<string, number | ArrayLike<number>>>;

/** Returns all of them as one list. */
export function numbersOf(named: NamedNumbers): number[] {
  return Object.values(named).flatMap((value) => (typeof value === 'number' ? value : Array.from(value)));
}
