import { numberOf } from '../data/number-of.ts';
import { type Counting, zeroCounters } from './engine-counters.ts';
import { linkShader, loadVariant, type ShaderMutation, type ShaderVariant } from './shaders/link-shader.ts';

/** A resource that a shader declares in group 0. */
export interface ShaderBinding {
  readonly name: string;
  readonly entry: Omit<GPUBindGroupLayoutEntry, 'visibility'>;
}

const DECLARATION = /@binding\((\d+)\)\s*var(?:<([^>]*)>)?\s*(\w+)\s*:\s*(\w+)(?:<(\w+))?/g;

const BUFFER_TYPES: Readonly<Record<string, GPUBufferBindingType>> = {
  uniform: 'uniform',
  'storage,read': 'read-only-storage',
  'storage,read_write': 'storage',
};

/**
 * Lists the resources that linked WGSL declares; textures as the engine's shaders use them, or with the
 * sampler that is named after them.
 */
export function shaderBindings(wgsl: string): ShaderBinding[] {
  const declared = [...wgsl.matchAll(DECLARATION)];
  const names = new Set(declared.map(([, , , name]) => name));
  return declared.map(([, binding, space, name, type, parameter]) => ({
    name,
    entry: {
      binding: Number(binding),
      ...(space ? bufferOf(space) : textureOf(type, parameter, names.has(`${name}Sampler`))),
    },
  }));
}

function bufferOf(space: string): Pick<GPUBindGroupLayoutEntry, 'buffer'> {
  return { buffer: { type: BUFFER_TYPES[space.replace(/\s/g, '')] } };
}

function textureOf(
  type: string,
  parameterOrFormat: string,
  isSampled: boolean,
): Pick<GPUBindGroupLayoutEntry, 'texture' | 'storageTexture' | 'sampler'> {
  if (type === 'sampler') return { sampler: { type: 'filtering' } };
  if (type.startsWith('texture_storage'))
    return { storageTexture: { access: 'write-only', format: parameterOrFormat as GPUTextureFormat } };
  const colors = isSampled ? 'float' : parameterOrFormat === 'u32' ? 'uint' : 'unfilterable-float';
  const sampleType = type.startsWith('texture_depth') ? 'depth' : colors;
  return { texture: { sampleType, multisampled: type.includes('multisampled') } };
}

/** An LRU cache: once it is full, a new entry evicts the least recently used one. */
export class RecentMap<Key, Value> {
  readonly #limit: number;
  /** A `Map` lists entries in the order in which they were added. */
  readonly #entries = new Map<Key, Value>();

  /** @param limit most entries. */
  constructor(limit: number) {
    this.#limit = limit;
  }

  /** Returns the value and makes it the most recently used. */
  get(key: Key): Value | undefined {
    const value = this.#entries.get(key);
    if (value !== undefined) this.set(key, value);
    return value;
  }

  set(key: Key, value: Value): void {
    this.#entries.delete(key);
    this.#entries.set(key, value);
    if (this.#entries.size <= this.#limit) return;
    const [oldest] = this.#entries.keys();
    this.#entries.delete(oldest);
  }

  delete(key: Key): void {
    this.#entries.delete(key);
  }
}

/** A stage as data: its shader, which declares its bindings, and its entry point. */
export interface StageDefinition extends ShaderVariant {
  /** Compute entry point; render stages have `vertexMain` and `fragmentMain`. */
  readonly entryPoint?: string;
}

/** A compute stage. Its entry point is its name in camel case, e.g. `cullSplats` of cull-splats. */
export function computeStage(stage: string, variant: Omit<StageDefinition, 'stage'> = {}): StageDefinition {
  return { stage, entryPoint: stage.replace(/-./g, ([, letter]) => letter.toUpperCase()), ...variant };
}

/** Targets, topology and depth state of a render stage. */
export interface RenderState {
  readonly topology: GPUPrimitiveTopology;
  readonly targets: GPUColorTargetState[];
  readonly depth?: GPUDepthStencilState;
}

/** A stage that draws, with everything that compiling it needs. */
export type RenderStage = readonly [StageDefinition, RenderState];

/** A stage with everything that compiling it needs. */
export type CompiledStage = StageDefinition | RenderStage;

/** Resources by the names of a shader's bindings; of textures, all is bound. */
export type Bindings = Readonly<
  Record<string, GPUBuffer | GPUBufferBinding | GPUTexture | GPUTextureView | GPUSampler | null | undefined>
>;

type Pipeline = GPUComputePipeline | GPURenderPipeline;

/** Layout of a shader's bindings, and their names. */
interface BindingLayout {
  readonly bindings: readonly ShaderBinding[];
  readonly layout: GPUBindGroupLayout;
}

interface Compiled {
  readonly pipeline: Pipeline;
  readonly layout: BindingLayout;
}

/**
 * Most pipelines in the cache, and as many shader texts and modules. A frame of one cloud runs 20
 * to 30 pipelines. Without a bound, a page that goes through settings or effects would collect one
 * pipeline per combination.
 */
export const MAX_KEPT_PIPELINES = 256;

/** Why a pipeline could not be made. */
interface Refusal {
  readonly cause: unknown;
  readonly module: GPUShaderModule;
  /** The first error of the device while it made module and pipeline; null if there was none. */
  readonly error: Promise<GPUError | null>;
}

/** Compiled pipelines of one device by inputs, so that its engines compile nothing twice. */
interface DeviceCache {
  /** By list of bindings: a few dozen. */
  readonly layouts: Map<string, BindingLayout>;
  /** By WGSL text. */
  readonly modules: RecentMap<string, GPUShaderModule>;
  readonly pipelines: RecentMap<string, Promise<Pipeline>>;
}

const caches = new WeakMap<GPUDevice, DeviceCache>();

/**
 * Links, compiles and caches pipelines, each variant once. Compiling never blocks: `compute` and
 * `render` return undefined until the pipeline exists, and `prepare` waits for it.
 *
 * A prepared stage object has its pipeline for as long as that object is held, as a live plan does
 * through its shape. Besides, the pipelines that were used last are kept, for equal stages of other
 * shapes.
 */
export class Pipelines {
  readonly #device: GPUDevice;
  readonly #mutation: ShaderMutation | undefined;
  readonly #cache: DeviceCache;
  readonly #linked = new RecentMap<string, string>(MAX_KEPT_PIPELINES);
  readonly #compiled = new RecentMap<string, Compiled>(MAX_KEPT_PIPELINES);
  /**
   * Pipelines by the identity of stage and render state: frames need no string keys. A compute stage
   * has no state, and its stage is the key twice.
   */
  readonly #found = new WeakMap<StageDefinition, WeakMap<StageDefinition | RenderState, Pipeline>>();
  /** Binding layouts of the stages in `#found`. */
  readonly #layouts = new WeakMap<StageDefinition, BindingLayout>();
  readonly #counting: Pick<Counting, 'pipelinesCompiled'>;

  /**
   * @param mutation for tests only: see ShaderMutation.
   * @param counting where to count compiled pipelines.
   */
  constructor(device: GPUDevice, mutation?: ShaderMutation, counting = zeroCounters()) {
    this.#device = device;
    this.#counting = counting;
    this.#mutation = mutation;
    this.#cache = caches.get(device) ?? newCache(device);
  }

  /** Returns the pipeline, or undefined while it is compiling. */
  compute(stage: StageDefinition): GPUComputePipeline | undefined {
    return this.#find(stage, undefined) as GPUComputePipeline | undefined;
  }

  render(stage: StageDefinition, state: RenderState): GPURenderPipeline | undefined {
    return this.#find(stage, state) as GPURenderPipeline | undefined;
  }

  /** Whether all of `stages` are compiled. */
  areReady(stages: readonly CompiledStage[]): boolean {
    return stages.every((entry) => ('stage' in entry ? this.compute(entry) : this.render(...entry)));
  }

  /** Compiles each of `stages` that is not compiled yet. The next call retries failures, but those of WGSL. */
  async prepare(stages: Iterable<CompiledStage>): Promise<void> {
    await Promise.all(
      Array.from(stages, async (entry) => {
        const [stage, state] = 'stage' in entry ? [entry, undefined] : entry;
        if (this.#find(stage, state)) return;
        const compiled = await this.#compile(stage, state);
        this.#compiled.set(keyOf(stage, state), compiled);
        // Bind to the stage at once: later entries may evict it from the LRU cache before the frame.
        this.#remember(stage, state, compiled);
      }),
    );
  }

  /** Makes a bind group for all bindings of a compiled stage; ignores other `resources`. */
  bindGroup(stage: StageDefinition, resources: Bindings): GPUBindGroup {
    if (!isRenderStage(stage)) this.#find(stage, undefined);
    const { bindings, layout } = this.#layouts.get(stage)!;
    const entries = bindings.map(({ name, entry: { binding } }) => {
      const resource = resources[name];
      if (!resource) throw new RangeError(`${stage.stage} needs a resource for its binding ${name}.`);
      return { binding, resource: toResource(resource) };
    });
    return this.#device.createBindGroup({ label: stage.stage, layout, entries });
  }

  /** Finds a pipeline. Frames pass the same objects again, so string keys are made once. */
  #find(stage: StageDefinition, state: RenderState | undefined): Pipeline | undefined {
    const known = this.#found.get(stage)?.get(state ?? stage);
    if (known) return known;
    const compiled = this.#compiled.get(keyOf(stage, state));
    if (compiled) this.#remember(stage, state, compiled);
    return compiled?.pipeline;
  }

  #remember(stage: StageDefinition, state: RenderState | undefined, { pipeline, layout }: Compiled): void {
    const byState = this.#found.get(stage) ?? new WeakMap();
    this.#found.set(stage, byState.set(state ?? stage, pipeline));
    this.#layouts.set(stage, layout);
  }

  async #compile(stage: StageDefinition, state: RenderState | undefined): Promise<Compiled> {
    // Only stages with texts to fetch wait; all others start compiling at once.
    const loaded = stage.later ? await loadVariant(stage) : stage;
    let code: string;
    try {
      code = this.#link(loaded);
    } catch (cause) {
      throw await this.#errorOf(loaded, cause);
    }
    const layout = this.#layout(stage, code);
    const key = JSON.stringify([code, stage.entryPoint, state]);
    const { pipelines } = this.#cache;
    let making = pipelines.get(key);
    if (!making) {
      this.#counting.pipelinesCompiled++;
      making = this.#make(stage, state, code, layout);
      pipelines.set(key, making);
      // What WGSL refuses stays refused; all else may pass.
      making.catch(({ cause }: Refusal) => {
        if ((cause as GPUPipelineError).reason !== 'validation') pipelines.delete(key);
      });
    }
    try {
      return { pipeline: await making, layout };
    } catch (refusal) {
      const { cause, module, error } = refusal as Refusal;
      throw await this.#errorOf(loaded, cause, module, await error);
    }
  }

  /** @returns the pipeline. Rejects with a Refusal. */
  #make(
    stage: StageDefinition,
    state: RenderState | undefined,
    code: string,
    layout: BindingLayout,
  ): Promise<Pipeline> {
    const device = this.#device;
    // The rejection of a pipeline only says that its module has an error, which the device reports apart.
    device.pushErrorScope('validation');
    const module = this.#module(stage, code);
    const pipeline = this.#create(stage, state, module, layout);
    // A lost device does not answer; its loss is reported elsewhere.
    const error = device.popErrorScope().catch(() => null);
    return pipeline.catch((cause: unknown) => {
      throw { cause, module, error } satisfies Refusal;
    });
  }

  async #errorOf(
    variant: StageDefinition,
    cause: unknown,
    module: GPUShaderModule | null = null,
    refusal: GPUError | null = null,
  ): Promise<unknown> {
    // Without the code that describes it, the error of the linker or the device has to do.
    const described = await import('./shaders/shader-error.ts').catch(() => null);
    return described?.shaderErrorOf({ variant, mutation: this.#mutation, cause, module, refusal }) ?? cause;
  }

  #link(stage: StageDefinition): string {
    const key = variantKey(stage);
    let linked = this.#linked.get(key);
    if (linked === undefined) {
      linked = linkShader(stage, this.#mutation);
      this.#linked.set(key, linked);
    }
    return linked;
  }

  #create(
    stage: StageDefinition,
    state: RenderState | undefined,
    module: GPUShaderModule,
    { layout: bindGroupLayout }: BindingLayout,
  ): Promise<Pipeline> {
    const layout = this.#device.createPipelineLayout({
      label: stage.stage,
      bindGroupLayouts: [bindGroupLayout],
    });
    const label = `${stage.stage} ${stage.entryPoint ?? ''}`.trim();
    if (!state) {
      return this.#device.createComputePipelineAsync({
        label,
        layout,
        compute: { module, entryPoint: stage.entryPoint },
      });
    }
    return this.#device.createRenderPipelineAsync({
      label,
      layout,
      vertex: { module, entryPoint: 'vertexMain' },
      fragment: { module, entryPoint: 'fragmentMain', targets: state.targets },
      primitive: { topology: state.topology },
      ...(state.depth && { depthStencil: state.depth }),
    });
  }

  #module({ stage }: StageDefinition, code: string): GPUShaderModule {
    const { modules } = this.#cache;
    const module = modules.get(code) ?? this.#device.createShaderModule({ label: stage, code });
    modules.set(code, module);
    return module;
  }

  #layout(stage: StageDefinition, code: string): BindingLayout {
    const { layouts } = this.#cache;
    const visibility = isRenderStage(stage)
      ? GPUShaderStage.VERTEX | GPUShaderStage.FRAGMENT
      : GPUShaderStage.COMPUTE;
    const bindings = shaderBindings(code);
    const key = JSON.stringify([bindings, visibility]);
    let known = layouts.get(key);
    if (!known) {
      const entries = bindings.map(({ entry }) => ({ ...entry, visibility }));
      known = { bindings, layout: this.#device.createBindGroupLayout({ label: stage.stage, entries }) };
      layouts.set(key, known);
    }
    return known;
  }
}

function newCache(device: GPUDevice): DeviceCache {
  const cache = {
    layouts: new Map(),
    modules: new RecentMap<string, GPUShaderModule>(MAX_KEPT_PIPELINES),
    pipelines: new RecentMap<string, Promise<Pipeline>>(MAX_KEPT_PIPELINES),
  };
  caches.set(device, cache);
  // Code that keeps a lost device alive should not keep its shaders.
  void device.lost.then(() => caches.delete(device));
  return cache;
}

/** Name of the stage that a pipeline was compiled for. */
export function stageNameOf({ label }: GPUObjectBase): string {
  return label.split(' ')[0];
}

function isRenderStage({ entryPoint }: StageDefinition): boolean {
  return entryPoint === undefined;
}

function toResource(value: NonNullable<Bindings[string]>): GPUBindingResource {
  if ('createView' in value) return value.createView();
  // Bindings of buffers have a size too.
  const isBuffer = 'size' in value && 'usage' in value;
  return isBuffer ? { buffer: value } : (value as GPUBindingResource);
}

function variantKey({ stage, conditions = {}, constants = {}, effects }: StageDefinition): string {
  return JSON.stringify([stage, conditions, constants, effects && numberOf(effects)]);
}

function keyOf(stage: StageDefinition, state?: RenderState): string {
  return JSON.stringify([variantKey(stage), stage.entryPoint, state]);
}
