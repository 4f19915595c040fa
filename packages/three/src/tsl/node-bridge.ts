// All knowledge of how three compiles nodes and keeps their time: three has no public way to compile
// nodes into a function of WGSL, nor to ask for the frame that it updates them for.
import { InvalidArgumentError } from '@websplatter/core';
import { context } from 'three/tsl';
import { Camera, Node, NodeFrame, REVISION, WGSLNodeBuilder } from 'three/webgpu';
import { ThreeInternalsError } from '../errors.ts';
import type { FramePlace } from '../layer/layer-cloud.ts';
import { checkTexture, type NodeResource, type ResourceNode, refusal } from './node-resources.ts';

/** A number that a splat has, as a node. */
export class SplatInputNode extends Node {
  /** Name of its export, such as `splatPosition`. */
  readonly inputName: string;

  constructor(inputName: string, nodeType: string) {
    super(nodeType as never);
    this.inputName = inputName;
  }

  override generate(builder: unknown): string {
    if (builder instanceof FlowBuilder) return builder.textOf(this);
    const message = `${this.inputName} stands in the nodes of a material: it is for those of splatNode().`;
    throw new InvalidArgumentError(this.inputName, message);
  }
}

/** WGSL types of uniforms in a struct of parameters, by three's types; its booleans are `uint`. */
const FIELD_TYPES = {
  float: 'f32',
  int: 'u32',
  uint: 'u32',
  vec2: 'vec2f',
  vec3: 'vec3f',
  color: 'vec3f',
  vec4: 'vec4f',
  mat3: 'mat3x3f',
  mat4: 'mat4x4f',
} as const;

export type FieldType = (typeof FIELD_TYPES)[keyof typeof FIELD_TYPES];

/** A uniform of the nodes, as the struct of parameters has it. */
export interface NodeValue {
  readonly type: FieldType;
  readonly node: { readonly value: unknown };
}

/** A node that is updated before its value is read. */
export interface UpdatedNode {
  update(frame: NodeFrame): void;
}

/** Result of a flow: `target = node` for each of `outputs`. */
interface CompiledFlow {
  /** Declarations that the statements use: functions, structs, constants. */
  readonly declarations: readonly string[];
  readonly statements: string;
}

/** The parts of three's builder that are used here. */
interface BuilderInternals {
  readonly codes: Readonly<Record<string, readonly { readonly code: string }[] | undefined>>;
  readonly updateNodes: readonly UpdatedNode[];
  setShaderStage(stage: string): void;
  flowStagesNode(node: Node, output: string | null): { readonly code: string; readonly vars: string };
  buildUpdateNodes(): void;
  addLineFlowCode(code: string): void;
  getType(type: string): string;
  getMethod(method: string, output: string | null): string;
  isAvailable(name: string): boolean;
  isContextAssign(): boolean;
  isUnfilterable(texture: unknown): boolean;
}

/** The part of a renderer that a builder reads. */
const NO_RENDERER = {
  // Colours of render targets are resolved before they are read.
  backend: { utils: { getTextureSampleData: () => ({ samples: 1, primarySamples: 1, isMSAA: false }) } },
  contextNode: /* @__PURE__ */ context({}),
  debug: { diagnostics: {} },
  library: {},
  getMRT: () => null,
  getRenderTarget: () => null,
};

const STAGE = 'compute';

/** A variable or uniform of a builder. */
interface NamedProperty {
  readonly name: string;
  readonly type: string;
  readonly isNodeUniform?: boolean;
}

/** Gives names to what nodes read. */
interface NodeNames {
  /** Name of a uniform in the struct of parameters. */
  value(node: object, type: FieldType): string;
  /** Name of a texture or buffer. */
  resource(node: ResourceNode, type: NodeResource['type']): string;
}

/** Types of three's that a storage buffer may have for its elements. */
interface ElementTypes {
  getNodeType(builder: unknown): string;
}

const INHERITED = WGSLNodeBuilder.prototype as unknown as BuilderInternals;

/** Compiles nodes into statements of a function, which read uniforms of `values`. */
class FlowBuilder extends WGSLNodeBuilder {
  readonly textOf: (input: SplatInputNode) => string;
  readonly #names: NodeNames;

  constructor(textOf: FlowBuilder['textOf'], names: NodeNames) {
    super(null as never, NO_RENDERER as never);
    // Nodes ask whether there are several.
    Object.assign(this, { camera: new Camera() });
    this.textOf = textOf;
    this.#names = names;
  }

  /** @throws InvalidArgumentError for uniforms, textures and buffers that splats cannot have. */
  getUniformFromNode(node: object, type: string): object {
    const fieldType: FieldType | undefined = FIELD_TYPES[type as keyof typeof FIELD_TYPES];
    if (fieldType) return { isNodeUniform: true, name: this.#names.value(node, fieldType), type };
    return { isNodeUniform: true, name: this.#resourceName(node as ResourceNode, type), type };
  }

  #resourceName(node: ResourceNode, type: string): string {
    const internals = this as unknown as BuilderInternals;
    if (/texture/i.test(type)) {
      checkTexture(node, type);
      return this.#names.resource(node, internals.isUnfilterable(node.value) ? 'texels' : 'texture');
    }
    if (!/storageBuffer/i.test(type))
      throw refusal(`a ${type}`, 'use numbers, vectors, colours, matrices, textures and storage buffers');
    if (node.structTypeNode) throw refusal('a storage buffer of structs', 'use one buffer for each member');
    if (node.isAtomic) throw refusal('an atomic storage buffer', 'read it by a node without toAtomic()');
    if (internals.isContextAssign())
      throw refusal('a storage buffer that they write', 'write it in compute() of the renderer');
    const { getNodeType } = node as ResourceNode & ElementTypes;
    return this.#names.resource(node, `array<${internals.getType(getNodeType.call(node, this))}>`);
  }

  getPropertyName({ name, type, isNodeUniform }: NamedProperty): string {
    if (!isNodeUniform || !(type in FIELD_TYPES)) return name;
    // Structs of parameters have no signed integers.
    return type === 'int' ? `bitcast<i32>( values.${name} )` : `values.${name}`;
  }

  /** No float32 texture is filtered: whether the device can is not known yet. */
  isAvailable(name: string): boolean {
    return name !== 'float32Filterable' && INHERITED.isAvailable.call(this, name);
  }

  /** @throws InvalidArgumentError for derivatives. */
  getMethod(method: string, output: string | null): string {
    // Outside of fragment shaders, three makes a comment of the first two.
    const [derivative] = method.match(/dFd[xy]|fwidth/) ?? [];
    if (derivative)
      throw refusal(`${derivative}()`, 'splats have no neighbours: compute the difference of two values');
    return INHERITED.getMethod.call(this, method, output);
  }

  /** @throws InvalidArgumentError always. */
  generateTextureBias(): never {
    throw refusal('bias() of a texture', 'splats have no derivatives to bias: name a level by level()');
  }

  /** @throws InvalidArgumentError always. */
  generateTextureGather(): never {
    throw refusal('gather() of a texture', 'read its texels one by one with textureLoad()');
  }

  /** @throws InvalidArgumentError always, like the next two: splats have inputs of their own. */
  hasGeometryAttribute(name: string): never {
    if (name.startsWith('uv'))
      throw refusal(
        `the attribute "${name}"`,
        'give each texture its coordinates: texture(map, splatPosition.xy)',
      );
    return refuse(`the attribute "${name}"`);
  }

  getBuiltin(_name: string, property: string): never {
    return refuse(property);
  }

  getInstanceIndex(): never {
    return refuse('instanceIndex');
  }
}

function refuse(used: string): never {
  const message =
    `The nodes of splatNode() use ${used}, which meshes have. Splats have splatPosition, ` +
    'splatPositionWorld, splatScale, splatRotation, splatOpacity, splatColor, splatIndex and splatRow.';
  throw new InvalidArgumentError('nodes', message);
}

/** Assigns each of its nodes to a target. */
class AssignmentsNode extends Node {
  readonly nodes: readonly Node[];
  readonly #outputs: readonly Output[];

  constructor(outputs: readonly Output[]) {
    super('void' as never);
    this.#outputs = outputs;
    // Found by three's own traversal, like all properties that are nodes.
    this.nodes = outputs.map(({ node }) => node);
  }

  override generate(builder: unknown): string {
    const internals = builder as BuilderInternals;
    // All values first: one target may be the input of another.
    const values = this.#outputs.map(({ node, type }) =>
      (node as unknown as { build(builder: unknown, output: string): string }).build(builder, type),
    );
    this.#outputs.forEach(({ assign }, i) => {
      internals.addLineFlowCode(assign(values[i]));
    });
    return '';
  }
}

/** A node, and the statement without `;` that takes its value. */
export interface Output {
  readonly node: Node;
  /** three's type of the value. */
  readonly type: string;
  readonly assign: (value: string) => string;
}

/**
 * Compiles nodes into the statements of functions, one after another, which read inputs by the given
 * texts and uniforms as members of `values`.
 */
export class NodeCompiler {
  /** Uniforms by the names of members. */
  readonly values = new Map<string, NodeValue>();
  /** Textures and buffers by their names in statements; samplers are named `NAME_sampler`. */
  readonly resources = new Map<string, NodeResource>();
  /** Nodes that are updated once per frame, before values are read. */
  readonly updates = new Set<UpdatedNode>();
  readonly #names = new Map<object, string>();

  /**
   * Compiles one flow.
   *
   * @throws InvalidArgumentError for nodes that splats cannot have; ThreeInternalsError if three has
   *   changed; errors of the nodes themselves.
   */
  compile(outputs: readonly Output[], textOf: (input: SplatInputNode) => string): CompiledFlow {
    const builder = new FlowBuilder(textOf, {
      value: (node, type) =>
        this.#nameOf(node, 'value', (name) =>
          this.values.set(name, { type, node: node as NodeValue['node'] }),
        ),
      resource: (node, type) =>
        this.#nameOf(node, 'splatResource', (name) => this.resources.set(name, { type, node })),
    });
    const internals = builder as unknown as BuilderInternals;
    for (const name of ['setShaderStage', 'flowStagesNode', 'buildUpdateNodes'] as const)
      if (typeof internals[name] !== 'function')
        throw new ThreeInternalsError(`WGSLNodeBuilder.${name}`, REVISION);
    internals.setShaderStage(STAGE);
    const { vars, code } = internals.flowStagesNode(new AssignmentsNode(outputs), null);
    internals.buildUpdateNodes();
    for (const node of internals.updateNodes) this.updates.add(node);
    return {
      declarations: (internals.codes[STAGE] ?? []).map((each) => each.code),
      statements: `${vars}${code}`,
    };
  }

  #nameOf(node: object, prefix: string, add: (name: string) => void): string {
    let name = this.#names.get(node);
    if (name === undefined) {
      name = `${prefix}${this.#names.size}`;
      this.#names.set(node, name);
      add(name);
    }
    return name;
  }
}

/** Returns a frame for nodes that splats have, at the time that the renderer's other nodes have. */
export function nodeFrameAt(place: FramePlace): NodeFrame {
  const { _nodes } = place.renderer as { readonly _nodes?: { readonly nodeFrame?: NodeFrame } };
  const frame = _nodes?.nodeFrame;
  if (!frame) throw new ThreeInternalsError('renderer._nodes.nodeFrame', REVISION);
  const { time, deltaTime, frameId, renderId } = frame;
  return Object.assign(new NodeFrame(), { time, deltaTime, frameId, renderId }, place);
}
