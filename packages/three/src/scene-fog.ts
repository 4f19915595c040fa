import { type EffectUse, type FogOptions, fog } from '@websplatter/core/effects';
import type { Fog, FogExp2, Scene } from 'three/webgpu';
import { encodedColor } from './effect-options.ts';
import { fogOfNode } from './fog-node.ts';

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
function fogOptionsOf(fog: Fog | FogExp2): FogOptions {
  const color = encodedColor(fog.color);
  if ('density' in fog) return { color, density: fog.density };
  // three accepts any numbers: if `far` is not beyond `near`, its fog is a wall at `near`.
  return { color, near: fog.near, far: Math.max(fog.far, fog.near + 1e-6) };
}
