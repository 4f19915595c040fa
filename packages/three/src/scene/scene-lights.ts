import type { Vec3 } from '@websplatter/core';
import type { LightCone } from '@websplatter/core/effects';
import { type Light, MathUtils, type Object3D, type Scene, type SpotLight } from 'three/webgpu';

/** Cones of spot lights, radians, from nearly none to nearly the half-space. */
const [NARROWEST_CONE, WIDEST_CONE] = [1e-3, 1.57];
const { clamp } = MathUtils;

/** Returns the visible lights of a scene, in the order of its tree. */
export function lightsIn(scene: Object3D): Light[] {
  const lights: Light[] = [];
  scene.traverseVisible((object) => (object as Light).isLight && lights.push(object as Light));
  return lights;
}

/** Returns linear red, green and blue of a light; three takes any numbers, and effects none below 0. */
export function irradianceOf({ color, intensity }: Pick<Light, 'color' | 'intensity'>): Vec3 {
  return [color.r, color.g, color.b].map((value) => Math.max(intensity * value, 0)) as unknown as Vec3;
}

/** Returns the cone of a spot light, within the ranges of effects. */
export function coneOf({ angle, penumbra, decay, distance }: SpotLight): LightCone {
  return {
    angle: clamp(angle, NARROWEST_CONE, WIDEST_CONE),
    penumbra: clamp(penumbra, 0, 1),
    decay: Math.max(decay, 0),
    distance: Math.max(distance, 0),
  };
}

/** Returns the irradiance of a scene's environment, which counts as one of radiance 1; 0 without any. */
export function environmentIrradiance({ environment, environmentNode, environmentIntensity }: Scene): number {
  return environment || environmentNode ? Math.PI * Math.max(environmentIntensity, 0) : 0;
}
