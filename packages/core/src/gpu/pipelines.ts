import { linkShader, type ShaderMutation, type ShaderVariant } from '../shaders.ts';

/** How a shader sees a resource. */
export type BindingKind = 'uniform' | 'read' | 'read-write' | 'texture';

/** A stage as data: which shader, where it starts, what it is bound to in group 0. */
export interface StageDefinition<Binding extends string = string> extends ShaderVariant {
  /** Compute entry point; render stages have `vertexMain` and `fragmentMain`. */
  readonly entryPoint?: string;
  readonly bindings: Readonly<Record<Binding, readonly [binding: number, kind: BindingKind]>>;
}

/** Formats and blending of a render stage. */
export interface RenderState {
  readonly format: GPUTextureFormat;
  readonly topology: GPUPrimitiveTopology;
  readonly blend?: GPUBlendState;
}

/** Buffers by the names that the stage gives its bindings. */
export type Bindings<Binding extends string> = Readonly<
  Record<Binding, GPUBuffer | GPUBufferBinding | GPUTextureView>
>;

type Pipeline = GPUComputePipeline | GPURenderPipeline;

/**
 * Links, compiles and keeps pipelines: each variant once. Compiling never blocks: `get` answers undefined until the
 * pipeline is there, and `ready` waits for it.
 */
export class Pipelines {
  readonly #device: GPUDevice;
  readonly #mutation: ShaderMutation | undefined;
  readonly #layouts = new Map<string, GPUBindGroupLayout>();
  readonly #modules = new Map<string, Promise<GPUShaderModule>>();
  readonly #compiling = new Map<string, Promise<Pipeline>>();
  readonly #compiled = new Map<string, Pipeline>();

  /** @param mutation for tests alone: see ShaderMutation. */
  constructor(device: GPUDevice, mutation?: ShaderMutation) {
    this.#device = device;
    this.#mutation = mutation;
  }

  /** The pipeline, or undefined while it is compiling. */
  compute(stage: StageDefinition): GPUComputePipeline | undefined {
    return this.#compiled.get(keyOf(stage)) as GPUComputePipeline | undefined;
  }

  render(stage: StageDefinition, state: RenderState): GPURenderPipeline | undefined {
    return this.#compiled.get(keyOf(stage, state)) as GPURenderPipeline | undefined;
  }

  /** Compiles what is not compiled yet. */
  async prepare(stages: Iterable<StageDefinition | readonly [StageDefinition, RenderState]>): Promise<void> {
    await Promise.all(
      Array.from(stages, (entry) => {
        const [stage, state] = 'bindings' in entry ? [entry, undefined] : entry;
        const key = keyOf(stage, state);
        let compiling = this.#compiling.get(key);
        if (!compiling) {
          compiling = this.#compile(stage, state);
          this.#compiling.set(key, compiling);
          compiling.then(
            (pipeline) => this.#compiled.set(key, pipeline),
            // A later call tries again.
            () => this.#compiling.delete(key),
          );
        }
        return compiling;
      }),
    );
  }

  /** Resources for all of the stage's bindings; others are ignored. */
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

  async #compile(stage: StageDefinition, state: RenderState | undefined): Promise<Pipeline> {
    const module = await this.#module(stage);
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
      fragment: {
        module,
        entryPoint: 'fragmentMain',
        targets: [state.blend ? { format: state.format, blend: state.blend } : { format: state.format }],
      },
      primitive: { topology: state.topology },
    });
  }

  #module(stage: StageDefinition): Promise<GPUShaderModule> {
    const key = variantKey(stage);
    let module = this.#modules.get(key);
    if (!module) {
      module = linkShader(stage, this.#mutation).then((code) =>
        this.#device.createShaderModule({ label: stage.stage, code }),
      );
      this.#modules.set(key, module);
    }
    return module;
  }

  #layout(stage: StageDefinition): GPUBindGroupLayout {
    const entries = Object.values(stage.bindings);
    const isRender = stage.entryPoint === undefined;
    const key = JSON.stringify([entries, isRender]);
    let layout = this.#layouts.get(key);
    if (!layout) {
      layout = this.#device.createBindGroupLayout({
        label: stage.stage,
        entries: entries.map(([binding, kind]) => layoutEntry(binding, kind, isRender)),
      });
      this.#layouts.set(key, layout);
    }
    return layout;
  }
}

function layoutEntry(binding: number, kind: BindingKind, isRender: boolean): GPUBindGroupLayoutEntry {
  const visibility = isRender ? GPUShaderStage.VERTEX | GPUShaderStage.FRAGMENT : GPUShaderStage.COMPUTE;
  if (kind === 'texture') return { binding, visibility, texture: { sampleType: 'unfilterable-float' } };
  const types = { uniform: 'uniform', read: 'read-only-storage', 'read-write': 'storage' } as const;
  return { binding, visibility, buffer: { type: types[kind] } };
}

function toResource(value: GPUBuffer | GPUBufferBinding | GPUTextureView): GPUBindingResource {
  const isBuffer = 'size' in value && 'usage' in value;
  return isBuffer ? { buffer: value } : (value as GPUBindingResource);
}

function variantKey({ stage, conditions = {}, constants = {} }: StageDefinition): string {
  return JSON.stringify([stage, conditions, constants]);
}

function keyOf(stage: StageDefinition, state?: RenderState): string {
  return JSON.stringify([variantKey(stage), stage.entryPoint, state]);
}
