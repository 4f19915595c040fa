// All knowledge of how three compiles nodes and keeps their time: three has no public way to compile
// nodes into a function of WGSL, nor to ask for the frame that it updates them for.
import { InvalidArgumentError } from '@websplatter/core';
import { context } from 'three/tsl';
import { Camera, Node, NodeFrame, REVISION, WGSLNodeBuilder } from 'three/webgpu';
import { ThreeInternalsError } from './errors.ts';
import type { FramePlace } from './layer-cloud.ts';

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
}

/** The part of a renderer that a builder reads. */
const NO_RENDERER = {
  backend: {},
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

/** Compiles nodes into statements of a function, which read uniforms of `values`. */
class FlowBuilder extends WGSLNodeBuilder {
  readonly textOf: (input: SplatInputNode) => string;
  readonly #nameOf: (node: object, type: FieldType) => string;

  constructor(textOf: FlowBuilder['textOf'], nameOf: (node: object, type: FieldType) => string) {
    super(null as never, NO_RENDERER as never);
    // Nodes ask whether there are several.
    Object.assign(this, { camera: new Camera() });
    this.textOf = textOf;
    this.#nameOf = nameOf;
  }

  /** @throws InvalidArgumentError for uniforms that are not numbers, vectors or matrices. */
  getUniformFromNode(node: object, type: string): object {
    const fieldType: FieldType | undefined = FIELD_TYPES[type as keyof typeof FIELD_TYPES];
    if (fieldType) return { isNodeUniform: true, name: this.#nameOf(node, fieldType), type };
    const message = `The nodes of splatNode() use a ${type}; they can use numbers, vectors, colours and matrices.`;
    throw new InvalidArgumentError('nodes', message);
  }

  getPropertyName({ name, type, isNodeUniform }: NamedProperty): string {
    if (!isNodeUniform) return name;
    // Structs of parameters have no signed integers.
    return type === 'int' ? `bitcast<i32>( values.${name} )` : `values.${name}`;
  }

  /** @throws InvalidArgumentError always, like the next two: splats have inputs of their own. */
  hasGeometryAttribute(name: string): never {
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
    'splatPositionWorld, splatScale, splatOpacity, splatColor and splatIndex.';
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
    const builder = new FlowBuilder(textOf, (node, type) => this.#nameOf(node, type));
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

  #nameOf(node: object, type: FieldType): string {
    let name = this.#names.get(node);
    if (name === undefined) {
      name = `value${this.#names.size}`;
      this.#names.set(node, name);
      this.values.set(name, { type, node: node as NodeValue['node'] });
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
