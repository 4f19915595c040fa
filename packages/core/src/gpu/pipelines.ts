import { numberOf } from '../data/number-of.ts';
import { type Counting, zeroCounters } from './engine-counters.ts';
import { RecentMap } from './recent-map.ts';
import { linkShader, loadVariant, type ShaderMutation, type ShaderVariant } from './shaders/link-shader.ts';

/** How a shader sees a resource. */
export type BindingKind =
  | 'uniform'
  | 'read'
  | 'read-write'
  | 'texture'
  | 'depth-texture'
  | 'multisampled-depth-texture'
  /** A texture that a compute shader writes. */
  | `${'bgra8unorm' | 'rgba8unorm' | 'rgba16float' | 'rgba32float' | 'r32float'} writes`;

/** A stage as data: its shader, its entry point, its bindings in group 0. */
export interface StageDefinition<Binding extends string = string> extends ShaderVariant {
  /** Compute entry point; render stages have `vertexMain` and `fragmentMain`. */
  readonly entryPoint?: string;
  readonly bindings: Readonly<Record<Binding, readonly [binding: number, kind: BindingKind]>>;
}

/** Targets, topology and depth state of a render stage. */
export interface RenderState {
  readonly topology: GPUPrimitiveTopology;
  readonly targets: GPUColorTargetState[];
  readonly depth?: GPUDepthStencilState;
}

/** A stage with everything that compiling it needs. */
export type CompiledStage = StageDefinition | readonly [StageDefinition, RenderState];

/** Resources by the stage's names of its bindings. */
export type Bindings<Binding extends string> = Readonly<
  Record<Binding, GPUBuffer | GPUBufferBinding | GPUTextureView>
>;

type Pipeline = GPUComputePipeline | GPURenderPipeline;

/**
 * Most pipelines that are kept for frames that may return, and as many shader texts and modules. A
 * frame of one cloud runs 20 to 30 of them; without a bound, a page that goes through settings or
 * effects would gather all that there are.
 */
export const MAX_KEPT_PIPELINES = 256;

/** Compiled pipelines of one device by inputs, so that its engines compile nothing twice. */
interface DeviceCache {
  /** As many as there are lists of bindings, a few dozen. */
  readonly layouts: Map<string, GPUBindGroupLayout>;
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
  readonly #compiled = new RecentMap<string, Pipeline>(MAX_KEPT_PIPELINES);
  /**
   * Pipelines by the identity of stage and state, which needs no string keys; those of compute
   * stages by the stage twice.
   */
  readonly #found = new WeakMap<StageDefinition, WeakMap<StageDefinition | RenderState, Pipeline>>();
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
    return stages.every((entry) => ('bindings' in entry ? this.compute(entry) : this.render(...entry)));
  }

  /** Compiles those of `stages` that are not compiled yet. The next call retries failures. */
  async prepare(stages: Iterable<CompiledStage>): Promise<void> {
    await Promise.all(
      Array.from(stages, async (entry) => {
        const [stage, state] = 'bindings' in entry ? [entry, undefined] : entry;
        if (this.#find(stage, state)) return;
        const pipeline = await this.#pipeline(stage, state);
        this.#compiled.set(keyOf(stage, state), pipeline);
        // Now: others may take its place in the map before the frame looks for it.
        this.#remember(stage, state, pipeline);
      }),
    );
  }

  /** Makes a bind group for all of the stage's bindings; ignores other entries of `bindings`. */
  bindGroup<Binding extends string>(
    stage: StageDefinition<Binding>,
    bindings: Bindings<NoInfer<Binding>>,
  ): GPUBindGroup {
    const names = Object.keys(stage.bindings) as Binding[];
    return this.#device.createBindGroup({
      label: stage.stage,
      layout: this.#layout(stage),
      entries: names.map((name) => ({
        binding: stage.bindings[name][0],
        resource: toResource(bindings[name]),
      })),
    });
  }

  /** Finds a pipeline. Frames pass the same objects again, so string keys are made once. */
  #find(stage: StageDefinition, state: RenderState | undefined): Pipeline | undefined {
    const known = this.#found.get(stage)?.get(state ?? stage);
    if (known) return known;
    const pipeline = this.#compiled.get(keyOf(stage, state));
    if (pipeline) this.#remember(stage, state, pipeline);
    return pipeline;
  }

  #remember(stage: StageDefinition, state: RenderState | undefined, pipeline: Pipeline): void {
    const byState = this.#found.get(stage) ?? new WeakMap();
    this.#found.set(stage, byState.set(state ?? stage, pipeline));
  }

  async #pipeline(stage: StageDefinition, state: RenderState | undefined): Promise<Pipeline> {
    // All others start compiling at once.
    const loaded = typeof stage.source === 'function' ? await loadVariant(stage) : stage;
    const code = this.#link(loaded);
    const key = JSON.stringify([code, stage.entryPoint, state, layoutKey(stage)]);
    const { pipelines } = this.#cache;
    let pipeline = pipelines.get(key);
    if (!pipeline) {
      this.#counting.pipelinesCompiled++;
      pipeline = this.#compile(stage, state, this.#module(stage, code));
      pipelines.set(key, pipeline);
      pipeline.catch(() => pipelines.delete(key));
    }
    return pipeline;
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

  #compile(
    stage: StageDefinition,
    state: RenderState | undefined,
    module: GPUShaderModule,
  ): Promise<Pipeline> {
    const layout = this.#device.createPipelineLayout({
      label: stage.stage,
      bindGroupLayouts: [this.#layout(stage)],
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

  #layout(stage: StageDefinition): GPUBindGroupLayout {
    const { layouts } = this.#cache;
    const key = layoutKey(stage);
    let layout = layouts.get(key);
    if (!layout) {
      layout = this.#device.createBindGroupLayout({
        label: stage.stage,
        entries: Object.values(stage.bindings).map(([binding, kind]) =>
          layoutEntry(binding, kind, isRenderStage(stage)),
        ),
      });
      layouts.set(key, layout);
    }
    return layout;
  }
}

function newCache(device: GPUDevice): DeviceCache {
  const cache = {
    layouts: new Map(),
    modules: new RecentMap<string, GPUShaderModule>(MAX_KEPT_PIPELINES),
    pipelines: new RecentMap<string, Promise<Pipeline>>(MAX_KEPT_PIPELINES),
  };
  caches.set(device, cache);
  // Holders of a lost device need not hold its shaders too.
  void device.lost.then(() => caches.delete(device));
  return cache;
}

/** Name of the stage, as in shaders/stages, that a pipeline was compiled for. */
export function stageNameOf({ label }: GPUObjectBase): string {
  return label.split(' ')[0];
}

function isRenderStage({ entryPoint }: StageDefinition): boolean {
  return entryPoint === undefined;
}

function layoutKey(stage: StageDefinition): string {
  return JSON.stringify([Object.values(stage.bindings), isRenderStage(stage)]);
}

function layoutEntry(binding: number, kind: BindingKind, isRender: boolean): GPUBindGroupLayoutEntry {
  const visibility = isRender ? GPUShaderStage.VERTEX | GPUShaderStage.FRAGMENT : GPUShaderStage.COMPUTE;
  if (kind === 'texture') return { binding, visibility, texture: { sampleType: 'unfilterable-float' } };
  if (kind === 'depth-texture' || kind === 'multisampled-depth-texture') {
    const multisampled = kind === 'multisampled-depth-texture';
    return { binding, visibility, texture: { sampleType: 'depth', multisampled } };
  }
  if (kind.endsWith(' writes')) {
    const format = kind.replace(' writes', '') as GPUTextureFormat;
    return { binding, visibility, storageTexture: { access: 'write-only', format } };
  }
  const types = { uniform: 'uniform', read: 'read-only-storage', 'read-write': 'storage' } as const;
  return { binding, visibility, buffer: { type: types[kind as keyof typeof types] } };
}

function toResource(value: GPUBuffer | GPUBufferBinding | GPUTextureView): GPUBindingResource {
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
