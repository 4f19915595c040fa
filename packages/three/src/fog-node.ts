// Reads the parts of three's nodes. If a release hides these, splats do not follow fog nodes.
import { densityFogFactor, float, fog, rangeFogFactor, vec3 } from 'three/tsl';
import { type Color, Fog, FogExp2 } from 'three/webgpu';

/** A call of one of TSL's functions. */
interface CallNode {
  readonly shaderNode?: object;
  readonly rawInputs?: readonly unknown[];
}

const [anyFog, anyRange, anyDensity] = [
  fog(vec3(0), float(0)),
  rangeFogFactor(float(0), float(1)),
  densityFogFactor(float(0)),
] as readonly CallNode[];

/**
 * Returns the fog of `fog(color, rangeFogFactor(near, far))` or `fog(color,
 * densityFogFactor(density))`, with the present values of its uniforms; null for every other node,
 * and for inputs that are computed.
 */
export function fogOfNode(fogNode: object): Fog | FogExp2 | null {
  const [colorInput, factor] = inputsOf(fogNode, anyFog) ?? [];
  const color = givenValue(colorInput) as Color | null;
  if (!color?.isColor || !factor) return null;
  const numbersOf = (example: CallNode) => inputsOf(factor, example)?.map((input) => numberOf(input));
  const [near, far] = numbersOf(anyRange) ?? [];
  if (near != null && far != null) return new Fog(color, near, far);
  const [density] = numbersOf(anyDensity) ?? [];
  return density == null ? null : new FogExp2(color, density);
}

/** Returns the inputs of `node` if it calls the same function as `example`. */
function inputsOf(node: CallNode, { shaderNode }: CallNode): readonly unknown[] | null {
  return (shaderNode && node.shaderNode === shaderNode && node.rawInputs) || null;
}

/** Returns a constant's or uniform's value, or one given in place of a node; null if computed. */
function givenValue(input: unknown): unknown {
  const node = input as { isNode?: boolean; isInputNode?: boolean; value?: unknown } | null | undefined;
  if (!node?.isNode) return input ?? null;
  return node.isInputNode ? node.value : null;
}

function numberOf(input: unknown): number | null {
  const value = givenValue(input);
  return typeof value === 'number' ? value : null;
}
