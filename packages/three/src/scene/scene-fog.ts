import { type EffectUse, type FogOptions, fog } from '@websplatter/core/effects';
import { densityFogFactor, float, rangeFogFactor, fog as tslFog, vec3 } from 'three/tsl';
import { type Color, Fog, FogExp2, type Scene } from 'three/webgpu';
import { encodedColor } from './effect-options.ts';

const warned = new WeakSet<Scene>();

/**
 * Returns the fog of a scene as an effect; empty without fog. Of a `fogNode`, splats support range
 * and density fog. For any other node they use the scene's `fog`; without one, they have no fog, and
 * the console has a warning, once per scene.
 *
 * @throws InvalidArgumentError for fog whose distances or density are not numbers.
 */
export function sceneFog(scene: Scene): EffectUse[] {
  const { fogNode } = scene as { fogNode?: object | null };
  const followed = (fogNode && fogOfNode(fogNode)) || (scene.fog as Fog | FogExp2 | null);
  if (followed) return [fog(fogOptionsOf(followed))];
  if (fogNode && !warned.has(scene)) {
    warned.add(scene);
    console.warn(
      'Splats follow a scene.fogNode of rangeFogFactor or densityFogFactor whose inputs are constants or uniforms, and not this ' +
        'one. Set scene.fog, too, to the Fog or FogExp2 that comes nearest: splats take that, and meshes go on following the ' +
        'node. With fog = false on the clouds, they stay clear without this warning.',
    );
  }
  return [];
}

/** Converts a scene's fog into the options of `fog`. */
function fogOptionsOf(followed: Fog | FogExp2): FogOptions {
  const color = encodedColor(followed.color);
  if ('density' in followed) return { color, density: followed.density };
  // three accepts any numbers: if `far` is not beyond `near`, its fog is a wall at `near`.
  return { color, near: followed.near, far: Math.max(followed.far, followed.near + 1e-6) };
}

/** A call of one of TSL's functions. */
interface CallNode {
  readonly shaderNode?: object;
  readonly rawInputs?: readonly unknown[];
}

// Reads the parts of three's nodes. If a release hides these, splats do not follow fog nodes.
const [anyFog, anyRange, anyDensity] = [
  tslFog(vec3(0), float(0)),
  rangeFogFactor(float(0), float(1)),
  densityFogFactor(float(0)),
] as readonly CallNode[];

/**
 * Returns the fog of `fog(color, rangeFogFactor(near, far))` or `fog(color,
 * densityFogFactor(density))`, with the present values of its uniforms; null for every other node,
 * and for inputs that are computed.
 */
function fogOfNode(fogNode: object): Fog | FogExp2 | null {
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
