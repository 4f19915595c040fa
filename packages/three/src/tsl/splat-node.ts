import { InvalidArgumentError } from '@websplatter/core';
import {
  defineEffect,
  type EffectFunction,
  type EffectPlace,
  type EffectReach,
  type EffectResource,
  type EffectResourceType,
  type EffectUse,
  effectResources,
  splatRows,
} from '@websplatter/core/effects';
import { cos, cross, dot, float, nodeObject, sin, vec3, vec4 } from 'three/tsl';
import type { Node } from 'three/webgpu';
import type { FrameUse } from '../layer/layer-cloud.ts';
import {
  type FieldType,
  NodeCompiler,
  type NodeValue,
  nodeFrameAt,
  type Output,
  SplatInputNode,
} from './node-bridge.ts';
import { gpuResourceOf, type NodeResource } from './node-resources.ts';

const input = <Type extends 'vec3' | 'vec4' | 'float' | 'uint'>(
  name: keyof typeof INPUTS,
  type: Type,
): Node<Type> => nodeObject(new SplatInputNode(name, type)) as unknown as Node<Type>;

/** WGSL text of each input, and the field of the parameters that it needs. */
const INPUTS = {
  splatPosition: { text: '( splat.position + values.origin )', field: 'origin' },
  splatPositionWorld: { text: '( values.toWorld * vec4f( splat.position, 1.0 ) ).xyz', field: 'toWorld' },
  splatScale: { text: 'splat.scale' },
  splatRotation: { text: 'splat.rotation.yzwx' },
  splatOpacity: { text: 'splat.opacity' },
  splatColor: { text: 'decodeSrgb( max( color, vec3f( 0.0 ) ) )' },
  splatIndex: { text: 'splatIndex' },
  splatRow: { text: 'splatRow' },
} as const satisfies Record<string, { text: string; field?: keyof typeof PLACES }>;

/** Fields with the cloud's placement: positions in shaders are relative to the cloud's origin. */
const PLACES = {
  origin: { type: 'vec3f', at: ({ origin }: EffectPlace) => origin },
  toWorld: { type: 'mat4x4f', at: toWorldAt },
} as const;

/**
 * Centre of the splat in its cloud's space; in `color`, after `position` has been applied.
 *
 * @example
 * const stretch = splatNode({ position: splatPosition.mul(vec3(1, 1.5, 1)) });
 */
export const splatPosition = /* @__PURE__ */ input('splatPosition', 'vec3');
/**
 * Centre of the splat in world space; in `color`, after `position` has been applied.
 *
 * @example
 * const byHeight = splatNode({ opacity: splatOpacity.mul(splatPositionWorld.y) });
 */
export const splatPositionWorld = /* @__PURE__ */ input('splatPositionWorld', 'vec3');
/**
 * Standard deviation along each of the splat's axes, in its cloud's space.
 *
 * @example
 * const thin = splatNode({ scale: splatScale.mul(0.5) });
 */
export const splatScale = /* @__PURE__ */ input('splatScale', 'vec3');
/**
 * Rotation of the splat's axes, in its cloud's space: a unit quaternion x, y, z, w.
 *
 * @example
 * const spin = splatNode({ rotation: turned(splatRotation, vec3(0, 1, 0), time) });
 */
export const splatRotation = /* @__PURE__ */ input('splatRotation', 'vec4');
/**
 * Opacity of the splat's centre, 0…1.
 *
 * @example
 * const blink = splatNode({ opacity: splatOpacity.mul(sin(time).abs()) });
 */
export const splatOpacity = /* @__PURE__ */ input('splatOpacity', 'float');
/**
 * Colour as seen from the camera, linear as all of three's colours are; only for `color`.
 *
 * @example
 * const red = splatNode({ color: splatColor.mul(vec3(1, 0.2, 0.2)) });
 */
export const splatColor = /* @__PURE__ */ input('splatColor', 'vec3');
/**
 * A number that the splat has in every frame, as a seed for noise; its row in the file is `splatRow`.
 *
 * @example
 * const flicker = splatNode({ opacity: splatOpacity.mul(sin(time.add(splatIndex.toFloat())).abs()) });
 */
export const splatIndex = /* @__PURE__ */ input('splatIndex', 'uint');
/**
 * Row of the splat in its file or in your arrays, as `pickAt` returns it: the index of its value in a
 * storage buffer with one for each row. 4294967295 for splats without a row: merged ones of `detail`,
 * those of coarser levels of streamed SOG and .rad, and previews of a load.
 *
 * @example
 * const values = instancedArray(new Float32Array(1000).fill(0.5), 'float'); // of a file with 1000 rows
 * const shaded = splatNode({ color: splatColor.mul(values.element(splatRow)) });
 */
export const splatRow = /* @__PURE__ */ input('splatRow', 'uint');

/**
 * Returns a rotation that is turned further, about an axis through the splat's centre.
 *
 * @param rotation quaternion x, y, z, w.
 * @param axis in the cloud's space, of any length but 0.
 * @param angleRad counter-clockwise, seen from where the axis points to.
 * @example
 * const rolling = splatNode({ rotation: turned(splatRotation, vec3(1, 0, 0), time) });
 */
export function turned(rotation: Node<'vec4'>, axis: Node<'vec3'>, angleRad: Node<'float'>): Node<'vec4'> {
  const half = float(angleRad).mul(0.5);
  const [turn, w] = [axis.normalize().mul(sin(half)), cos(half)];
  const vector = rotation.xyz.mul(w).add(turn.mul(rotation.w)).add(cross(turn, rotation.xyz));
  return vec4(vector, rotation.w.mul(w).sub(dot(turn, rotation.xyz)));
}

/** New properties of each splat as nodes of three's; undefined ones stay unchanged. */
export interface SplatNodes {
  /** Centre in the cloud's space. */
  readonly position?: Node<'vec3'>;
  /** Standard deviations along the splat's axes in the cloud's space, or one for all of them. */
  readonly scale?: Node<'vec3'> | Node<'float'>;
  /**
   * Rotation of the splat's axes in the cloud's space: a quaternion x, y, z, w of any length but 0.
   * View-dependent colours do not turn with it.
   */
  readonly rotation?: Node<'vec4'>;
  /** Opacity of the centre, 0…1. */
  readonly opacity?: Node<'float'>;
  /** Colour, linear. */
  readonly color?: Node<'vec3'> | Node<'color'>;
  /**
   * Bounds for culling chunks: the farthest that `position` moves a splat, in the cloud's units, and
   * the largest factor by which `scale` enlarges it. Default: no bound; with `position` or `scale`,
   * no chunk is culled.
   */
  readonly reach?: Partial<Omit<EffectReach, 'blur'>>;
}

type Values = Readonly<Record<string, number | readonly number[]>>;

/** Above any growth; finite, as it is multiplied by sizes that may be 0. */
const ANY_GROWTH = 1e9;

/** Options of a program's uses. */
interface ProgramOptions {
  readonly reach: EffectReach;
  /** @throws InvalidArgumentError for a uniform that is not finite. */
  readonly read: () => Values;
  /** Returns the textures and buffers by the names in statements. */
  readonly resources: () => Readonly<Record<string, EffectResource>>;
}

/** Programs by text: nodes that are made again, as in a render of React, reuse their shader. */
const programs = new Map<string, EffectFunction<ProgramOptions>>();

/**
 * Makes an effect of three's nodes (TSL). They are compiled into the shaders that project splats;
 * uniforms, `time`, textures and storage buffers change without compiling again. Combine it with effects of
 * @websplatter/core/effects.
 *
 * @throws InvalidArgumentError without nodes, for values that are not nodes, and for nodes that splats
 *   do not support: attributes of meshes, derivatives, textures that are not 2D or hold videos, depth
 *   or integers; ThreeInternalsError if three has changed. Frames throw InvalidArgumentError for more
 *   textures or buffers than a shader of the device may read.
 * @example
 * const sway = sin(splatPosition.y.mul(6).add(time)).mul(0.1);
 * const wind = splatNode({
 *   position: splatPosition.add(vec3(sway, 0, 0)),
 *   reach: { displacement: 0.1 },
 * });
 * cloud.effects = [wind];
 */
export function splatNode(nodes: SplatNodes): EffectUse {
  const { position, scale, rotation, opacity, color, reach = {} } = nodes ?? {};
  for (const [name, node] of Object.entries({ position, scale, rotation, opacity, color }))
    if (node !== undefined && !(node as Partial<Node> | null)?.isNode)
      throw new InvalidArgumentError(
        name,
        `${name} is no node of three's; \`${name}: float(0.5)\` would be one.`,
      );
  for (const [name, most] of Object.entries(reach))
    if (!(most >= 0))
      throw new InvalidArgumentError(`reach.${name}`, `reach.${name} is ${most}; it must be 0 or more.`);
  const move: Output[] = [];
  if (position)
    move.push({
      node: vec3(position),
      type: 'vec3',
      assign: (value) => `changed.position = ${value} - values.origin`,
    });
  if (scale)
    move.push({
      node: vec3(scale as Node<'vec3'>),
      type: 'vec3',
      assign: (value) => `changed.scale = max( ${value}, vec3f( 0.0 ) )`,
    });
  if (rotation)
    move.push({
      node: vec4(rotation),
      type: 'vec4',
      assign: (value) => `changed.rotation = unitRotation( ${value}, splat.rotation )`,
    });
  if (opacity) {
    // A merged splat has an opacity above 1.
    const most = 'max( 1.0, splat.opacity )';
    move.push({
      node: float(opacity),
      type: 'float',
      assign: (value) => `changed.opacity = clamp( ${value}, 0.0, ${most} )`,
    });
  }
  const shade: Output[] = color
    ? [
        {
          node: vec3(color as Node<'vec3'>),
          type: 'vec3',
          assign: (value) => `changed = encodeSrgb( ${value} )`,
        },
      ]
    : [];
  if (move.length + shade.length === 0) {
    const message =
      'splatNode() has no position, scale, rotation, opacity or color: it would change nothing.';
    throw new InvalidArgumentError('nodes', message);
  }

  const compiler = new NodeCompiler();
  const places = new Set<keyof typeof PLACES>(position && ['origin']);
  let takesRow = false;
  const textOf = ({ inputName }: SplatInputNode, isColor: boolean) => {
    const found: { text: string; field?: keyof typeof PLACES } = INPUTS[inputName as keyof typeof INPUTS];
    if (inputName === 'splatColor' && !isColor) {
      const message = 'splatColor is found after a splat has its place and opacity: use it in `color` alone.';
      throw new InvalidArgumentError('splatColor', message);
    }
    if (found.field) places.add(found.field);
    if (inputName === 'splatRow') takesRow = true;
    return found.text;
  };
  const moved = compiler.compile(move, (node) => textOf(node, false));
  const shaded = compiler.compile(shade, (node) => textOf(node, true));

  const fields: Record<string, FieldType> = {};
  for (const name of places) fields[name] = PLACES[name].type;
  for (const [name, { type }] of compiler.values) fields[name] = type;
  const types = Object.fromEntries([...compiler.resources].map(([name, { type }]) => [name, type]));
  const program = programOf(fields, types, {
    declarations: [...new Set([...moved.declarations, ...shaded.declarations])].join('\n'),
    move: move.length > 0 ? moved.statements : null,
    shade: color ? shaded.statements : null,
    takesRow,
  });
  const { displacement = position ? Number.POSITIVE_INFINITY : 0 } = reach;
  const { growth = scale ? ANY_GROWTH : 1 } = reach;
  const read = () => valuesOf(compiler.values);
  const useWith = (given: Pick<ProgramOptions, 'read' | 'resources'>) =>
    program({ reach: { displacement, growth }, ...given });
  const use: FrameUse = {
    ...useWith({ read, resources: refuseWithoutRenderer }),
    inFrame(place) {
      const frame = nodeFrameAt(place);
      for (const node of compiler.updates) node.update(frame);
      const values = read();
      const resources = resourcesOf(compiler.resources, place.renderer);
      return useWith({ read: () => values, resources: () => resources });
    },
  };
  return use;
}

function refuseWithoutRenderer(): never {
  const message =
    'The nodes of splatNode() read textures or buffers, which a renderer of three’s uploads: draw them as `effects` of a SplatCloudObject.';
  throw new InvalidArgumentError('nodes', message);
}

/** Returns the textures and buffers that the renderer has now. */
function resourcesOf(
  resources: ReadonlyMap<string, NodeResource>,
  renderer: object,
): Record<string, EffectResource> {
  return Object.fromEntries(
    [...resources].map(([name, resource]) => [name, gpuResourceOf(renderer, resource)]),
  );
}

/** Statements of a program's functions; null for a function that is not needed. */
interface ProgramText {
  readonly declarations: string;
  readonly move: string | null;
  readonly shade: string | null;
  readonly takesRow: boolean;
}

function programOf(
  fields: Readonly<Record<string, FieldType>>,
  types: Readonly<Record<string, EffectResourceType>>,
  text: ProgramText,
): EffectFunction<ProgramOptions> {
  const key = JSON.stringify([fields, types, text]);
  const known = programs.get(key);
  if (known) return known;
  const number = programs.size + 1;
  const names = Object.keys(fields);
  const program = defineEffect<ProgramOptions, Record<string, FieldType>>({
    name: `splat-node-${number}`,
    label: 'Nodes of three',
    about: 'Changes splats by nodes of three’s shading language.',
    hooks: {
      ...(text.move !== null && { splat: `moveByNode${number}` }),
      ...(text.shade !== null && { color: `shadeByNode${number}` }),
    },
    wgsl: wgslOf(text, number, names.length > 0),
    ...(text.takesRow && { rows: splatRows }),
    ...(Object.keys(types).length > 0 && {
      resources: effectResources(types, ({ resources }: ProgramOptions) => resources()),
    }),
    ...(names.length > 0 && { fields }),
    calledFor: () => 'nodes change what splats are',
    reach: ({ reach }) => reach,
    valuesAt: ({ read }, place) => ({
      ...Object.fromEntries(
        Object.entries(PLACES).flatMap(([name, { at }]) => (name in fields ? [[name, at(place)]] : [])),
      ),
      ...read(),
    }),
  });
  programs.set(key, program);
  return program;
}

function wgslOf(
  { declarations, move, shade, takesRow }: ProgramText,
  number: number,
  hasValues: boolean,
): string {
  const struct = `SplatNode${number}`;
  const more = `${takesRow ? ', splatRow: u32' : ''}${hasValues ? `, parameters: ${struct}` : ''}`;
  // Functions of nodes take no parameters.
  const begin = hasValues ? '  values = parameters;\n' : '';
  const lines = [
    'import package::lib::packing::Splat;',
    ...(shade === null ? [] : ['import package::lib::srgb::{decodeSrgb, encodeSrgb};']),
    ...(hasValues ? [`import parameters::${struct};`, `var<private> values: ${struct};`] : []),
    declarations,
    ...(move?.includes('unitRotation(') ? [UNIT_ROTATION] : []),
  ];
  if (move !== null)
    lines.push(
      `fn moveByNode(splat: Splat, splatIndex: u32${more}) -> Splat {`,
      `${begin}  var changed = splat;${move}`,
      '  return changed;\n}',
    );
  if (shade !== null)
    lines.push(
      `fn shadeByNode(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f${more}) -> vec3f {`,
      `${begin}  var changed = color;${shade}`,
      '  return changed;\n}',
    );
  return withResources(numbered(lines.join('\n'), number), number);
}

/** Reads a quaternion x, y, z, w, unless it has no direction. */
const UNIT_ROTATION = `fn unitRotation(rotation: vec4f, otherwise: vec4f) -> vec4f {
  let largest = max(max(abs(rotation.x), abs(rotation.y)), max(abs(rotation.z), abs(rotation.w)));
  if (!(largest > 1e-20 && largest < 1e20)) { return otherwise; }
  return normalize(rotation.wxyz / largest);
}`;

/** Imports the textures and buffers that `wgsl` reads, by the names that `effectResources` gives them. */
function withResources(wgsl: string, number: number): string {
  const imported = new Set<string>();
  const named = wgsl.replace(/\b(splatResource\d+)(_sampler)?\b/g, (_, name: string, sampler?: string) => {
    const full = `splatNode${number}${name[0].toUpperCase()}${name.slice(1)}${sampler ? 'Sampler' : ''}`;
    imported.add(full);
    return full;
  });
  return imported.size === 0 ? wgsl : `import parameters::{${[...imported].join(', ')}};\n${named}`;
}

/** Adds `number` to the names that `wgsl` declares: one cloud may have several such effects. */
function numbered(wgsl: string, number: number): string {
  const declared = [...wgsl.matchAll(/^(?:fn|struct|const|var<private>)\s+(\w+)/gm)].map(([, name]) => name);
  if (declared.length === 0) return wgsl;
  const names = new RegExp(`(?<![.\\w])(?:${declared.join('|')})(?!\\w)`, 'g');
  return wgsl.replace(names, (name) => name + number);
}

/** Returns the present values of uniforms. */
function valuesOf(uniforms: ReadonlyMap<string, NodeValue>): Values {
  const values: Record<string, number | number[]> = {};
  for (const [name, { node }] of uniforms) {
    const { value } = node;
    const numbers = isVector(value) ? value.toArray() : [Number(value)];
    if (!numbers.every((number) => Number.isFinite(Math.fround(number)))) {
      const message = `A uniform of splatNode() holds ${numbers.join(', ')}; its values must be finite.`;
      throw new InvalidArgumentError('uniform', message);
    }
    values[name] = numbers.length === 1 ? numbers[0] : numbers;
  }
  return values;
}

/** Whether a uniform's value is one of three's vectors, colours or matrices. */
function isVector(value: unknown): value is { toArray(): number[] } {
  return typeof (value as { toArray?: unknown } | null)?.toArray === 'function';
}

/** Returns the matrix from positions relative to the cloud's origin to world space, from float64. */
function toWorldAt({ modelMatrix, origin: [x, y, z] }: EffectPlace): number[] {
  const m = Array.from(modelMatrix);
  const offset = [0, 1, 2].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]);
  return [...m.slice(0, 12), ...offset, 1];
}
