import type { DepthConvention, Vec3 } from '@websplatter/core';
import { type EffectUse, type ShadowLight, shadows } from '@websplatter/core/effects';
import {
  type AmbientLight,
  type Camera,
  Color,
  type DirectionalLight,
  type HemisphereLight,
  type Light,
  MathUtils,
  type Object3D,
  type Scene,
  type SpotLight,
  type WebGPURenderer,
} from 'three/webgpu';
import { splatEngineOf } from './adopt-renderer.ts';
import { engineCamera } from './layer-request.ts';
import type { RendererInternals, TextureData } from './three-bridge.ts';

/** Most lights whose shadows one cloud receives. */
const MOST_LIGHTS = 4;
/** Cones of spot lights, radians, from nearly none to nearly the half-space. */
const [NARROWEST_CONE, WIDEST_CONE] = [1e-3, 1.57];
const { clamp } = MathUtils;

/** The shadows of three's lights as an effect on splats. */
export class SceneShadows {
  readonly #timesDrawn: WeakMap<Camera, number>;
  /** Whether there have been shadows: the effect stays then, so that no shader must be compiled. */
  #isHeld = false;
  #noMap: GPUTexture | null = null;

  /** @param timesDrawn how often three has drawn a shadow map, by its camera. */
  constructor(timesDrawn: WeakMap<Camera, number>) {
    this.#timesDrawn = timesDrawn;
  }

  /**
   * Returns the effect of the visible lights' shadows; null if there never were any. Light without
   * shadows counts as on a white surface that faces it: ambient, hemisphere and directional lights,
   * and an environment as one of radiance 1.
   */
  effectIn(renderer: WebGPURenderer, scene: Scene): EffectUse | null {
    const lights: ShadowLight[] = [];
    const steady = new Color(0, 0, 0);
    scene.traverseVisible((object) => {
      if (!(object as Light).isLight) return;
      const found = lights.length < MOST_LIGHTS ? shadowLightOf(object, renderer) : null;
      if (found) {
        const version = this.#timesDrawn.get((object as DirectionalLight).shadow.camera);
        lights.push({ ...found, version });
      } else addSteady(object, steady);
    });
    const { environmentIntensity } = scene;
    const radiance = scene.environment || scene.environmentNode ? Math.PI * environmentIntensity : 0;
    if (lights.length === 0 && !this.#isHeld) return null;
    this.#isHeld = true;
    if (lights.length === 0) lights.push(this.#noLight(renderer));
    return shadows({
      lights,
      steady: [steady.r, steady.g, steady.b].map((value) => Math.max(value + radiance, 0)) as unknown as Vec3,
    });
  }

  dispose(): void {
    this.#noMap?.destroy();
    this.#noMap = null;
  }

  /** A light without light: the maps of former lights may be freed. */
  #noLight(renderer: WebGPURenderer): ShadowLight {
    this.#noMap ??= splatEngineOf(renderer).device.createTexture({
      label: 'no shadow map',
      size: [1, 1],
      format: 'depth32float',
      usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.RENDER_ATTACHMENT,
    });
    const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    const camera = { viewMatrix: identity, projectionMatrix: identity, near: 0, far: 1 };
    return { map: this.#noMap, version: 0, camera, irradiance: [0, 0, 0] };
  }
}

/** Returns a directional or spot light whose shadow map three has drawn; null for others. */
function shadowLightOf(object: Object3D, renderer: WebGPURenderer): ShadowLight | null {
  const light = object as DirectionalLight | SpotLight;
  const isSpot = (light as SpotLight).isSpotLight === true;
  if (!isSpot && !(light as DirectionalLight).isDirectionalLight) return null;
  if (!light.castShadow || !renderer.shadowMap.enabled) return null;
  const { shadow, color, intensity } = light;
  const depthTexture = shadow.map?.depthTexture;
  const { backend } = renderer as unknown as RendererInternals;
  const map = depthTexture && (backend.get(depthTexture) as TextureData).texture;
  if (!map) return null;
  const depth: DepthConvention = {
    compare: renderer.reversedDepthBuffer ? 'greater-equal' : 'less-equal',
    mapping: renderer.logarithmicDepthBuffer ? 'logarithmic' : 'projection',
  };
  const { angle, penumbra, decay, distance } = light as SpotLight;
  return {
    map,
    camera: engineCamera(shadow.camera, depth.compare === 'greater-equal'),
    depth,
    // three takes any numbers, and the effect those that have a meaning.
    irradiance: [color.r, color.g, color.b].map((value) => Math.max(intensity * value, 0)) as unknown as Vec3,
    ...(isSpot && {
      cone: {
        angle: clamp(angle, NARROWEST_CONE, WIDEST_CONE),
        penumbra: clamp(penumbra, 0, 1),
        decay: Math.max(decay, 0),
        distance: Math.max(distance, 0),
      },
    }),
    strength: clamp(shadow.intensity, 0, 1),
    bias: shadow.bias,
    offset: Math.max(shadow.normalBias, 0),
  };
}

/** Adds the light that surfaces get from `object` wherever they are. */
function addSteady(object: Object3D, sum: Color): void {
  const { color, intensity } = object as Light;
  const add = (of: Color, factor: number) => sum.add(of.clone().multiplyScalar(factor));
  if ((object as AmbientLight).isAmbientLight || (object as DirectionalLight).isDirectionalLight)
    add(color, intensity);
  else if ((object as HemisphereLight).isHemisphereLight) {
    add(color, intensity / 2);
    add((object as HemisphereLight).groundColor, intensity / 2);
  }
}
