// Code for clouds that the scene's lights light, as few scenes have.
import type { Vec3 } from '@websplatter/core';
import { type EffectUse, type RelightLight, relight } from '@websplatter/core/effects';
import {
  type AmbientLight,
  Color,
  type DirectionalLight,
  type HemisphereLight,
  type Light,
  type PointLight,
  type Scene,
  type SpotLight,
  Vector3,
} from 'three/webgpu';
import { coneOf, environmentIrradiance, irradianceOf, lightsIn } from './scene-lights.ts';

/**
 * Returns the visible lights of a scene as an effect on splats, in three's units: ambient, hemisphere,
 * directional, point and spot lights, and an environment as one of radiance 1. Others do not count.
 * Empty for a cloud that has the effect of its own.
 *
 * @param strength from 0, colours as captured, to 1.
 * @param own effects of the cloud.
 * @throws InvalidArgumentError for more lights than the effect takes, or numbers that are none.
 */
export function sceneRelight(scene: Scene, strength: number, own: readonly EffectUse[]): EffectUse[] {
  if (own.some(({ effect }) => effect === relight.effect)) return [];
  const radiance = environmentIrradiance(scene);
  const ambient = new Color(radiance, radiance, radiance);
  const lights: RelightLight[] = [];
  for (const light of lightsIn(scene)) {
    if ((light as AmbientLight).isAmbientLight)
      ambient.add(light.color.clone().multiplyScalar(light.intensity));
    const found = relightOf(light);
    if (found) lights.push(found);
  }
  return [relight({ lights, ambient: irradianceOf({ color: ambient, intensity: 1 }), strength })];
}

/** Returns a light as the effect has it; null for one of another kind. */
function relightOf(light: Light): RelightLight | null {
  const irradiance = irradianceOf(light);
  const position = placeOf(light).toArray();
  if ((light as HemisphereLight).isHemisphereLight) {
    const { groundColor: color, intensity } = light as HemisphereLight;
    // Like three, by the light's place.
    const up = directionOf(placeOf(light));
    return { kind: 'hemisphere', irradiance, ground: irradianceOf({ color, intensity }), up };
  }
  if ((light as PointLight).isPointLight) {
    const { decay, distance } = light as PointLight;
    return {
      kind: 'point',
      irradiance,
      position,
      decay: Math.max(decay, 0),
      distance: Math.max(distance, 0),
    };
  }
  const isDirectional = (light as DirectionalLight).isDirectionalLight;
  if (!isDirectional && !(light as SpotLight).isSpotLight) return null;
  const direction = directionOf(placeOf((light as DirectionalLight).target).sub(placeOf(light)));
  if (isDirectional) return { kind: 'directional', irradiance, direction };
  return { kind: 'spot', irradiance, position, direction, cone: coneOf(light as SpotLight) };
}

function placeOf({ matrixWorld }: Light | DirectionalLight['target']): Vector3 {
  return new Vector3().setFromMatrixPosition(matrixWorld);
}

/** Of a light at its target, any direction: three has none then. */
function directionOf(way: Vector3): Vec3 {
  return way.lengthSq() > 0 ? way.toArray() : [0, 1, 0];
}
