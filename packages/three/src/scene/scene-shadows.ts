import type { DepthConvention } from '@websplatter/core';
import { type EffectUse, type ShadowLight, shadows } from '@websplatter/core/effects';
import { vec3 } from 'three/tsl';
import {
  type AmbientLight,
  type Camera,
  Color,
  type DirectionalLight,
  type HemisphereLight,
  type Light,
  MathUtils,
  MeshLambertNodeMaterial,
  type Scene,
  type SpotLight,
  type WebGPURenderer,
} from 'three/webgpu';
import { engineCamera } from '../layer/layer-request.ts';
import { ViewportTriangle } from '../layer/viewport-triangle.ts';
import { splatEngineOf } from '../renderer/adopt-renderer.ts';
import type { RendererInternals, TextureData } from '../renderer/three-bridge.ts';
import { coneOf, environmentIrradiance, irradianceOf, lightsIn } from './scene-lights.ts';

/** Most lights whose shadows one cloud receives. */
const MOST_LIGHTS = 4;

/** Counts how often three has drawn each shadow map, by its camera. */
const timesDrawn = new WeakMap<Camera, number>();

/**
 * A lit object without pixels: three draws shadow maps only for lit objects that receive shadows,
 * before it draws them. It is opaque, and so comes before all splats.
 */
class LitTriangle extends ViewportTriangle<MeshLambertNodeMaterial> {
  constructor() {
    const material = new MeshLambertNodeMaterial();
    material.normalNode = vec3(0, 0, 1);
    material.colorWrite = false;
    material.depthWrite = false;
    super(material, 0);
    this.count = 0;
    this.receiveShadow = true;
    // To be told of each shadow map.
    this.castShadow = true;
  }

  override onBeforeShadow(_renderer: unknown, _object: unknown, camera: Camera): void {
    timesDrawn.set(camera, (timesDrawn.get(camera) ?? 0) + 1);
  }
}

/** The shadows of three's lights as an effect on splats. */
export class SceneShadows {
  /** Has three draw shadow maps while it is visible. */
  readonly lit = new LitTriangle();
  /** Whether there have been shadows: the effect stays then, so that no shader must be compiled. */
  #isHeld = false;
  #noMap: GPUTexture | null = null;

  /**
   * Returns the effect of the visible lights' shadows; null if there never were any, and while no cloud
   * receives them. Light without shadows counts as on a white surface that faces it: ambient,
   * hemisphere and directional lights, and an environment as one of radiance 1.
   */
  effectIn(renderer: WebGPURenderer, scene: Scene): EffectUse | null {
    if (!this.lit.visible) return null;
    const lights: ShadowLight[] = [];
    const radiance = environmentIrradiance(scene);
    const steady = new Color(radiance, radiance, radiance);
    for (const light of lightsIn(scene)) {
      const found = lights.length < MOST_LIGHTS ? shadowLightOf(light, renderer) : null;
      if (found) {
        const version = timesDrawn.get((light as DirectionalLight).shadow.camera);
        lights.push({ ...found, version });
      } else addSteady(light, steady);
    }
    if (lights.length === 0 && !this.#isHeld) return null;
    this.#isHeld = true;
    if (lights.length === 0) lights.push(this.#noLight(renderer));
    return shadows({ lights, steady: irradianceOf({ color: steady, intensity: 1 }) });
  }

  dispose(): void {
    this.lit.material.dispose();
    this.lit.geometry.dispose();
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
function shadowLightOf(object: Light, renderer: WebGPURenderer): ShadowLight | null {
  const light = object as DirectionalLight | SpotLight;
  const isSpot = (light as SpotLight).isSpotLight === true;
  if (!isSpot && !(light as DirectionalLight).isDirectionalLight) return null;
  if (!light.castShadow || !renderer.shadowMap.enabled) return null;
  const { shadow } = light;
  const depthTexture = shadow.map?.depthTexture;
  const { backend } = renderer as unknown as RendererInternals;
  const map = depthTexture && (backend.get(depthTexture) as TextureData).texture;
  if (!map) return null;
  const depth: DepthConvention = {
    compare: renderer.reversedDepthBuffer ? 'greater-equal' : 'less-equal',
    mapping: renderer.logarithmicDepthBuffer ? 'logarithmic' : 'projection',
  };
  return {
    map,
    camera: engineCamera(shadow.camera, depth.compare === 'greater-equal'),
    depth,
    irradiance: irradianceOf(light),
    ...(isSpot && { cone: coneOf(light as SpotLight) }),
    strength: MathUtils.clamp(shadow.intensity, 0, 1),
    bias: shadow.bias,
    offset: Math.max(shadow.normalBias, 0),
  };
}

/** Adds the light that surfaces get from `object` wherever they are. */
function addSteady(object: Light, sum: Color): void {
  const { color, intensity } = object;
  const add = (of: Color, factor: number) => sum.add(of.clone().multiplyScalar(factor));
  if ((object as AmbientLight).isAmbientLight || (object as DirectionalLight).isDirectionalLight)
    add(color, intensity);
  else if ((object as HemisphereLight).isHemisphereLight) {
    add(color, intensity / 2);
    add((object as HemisphereLight).groundColor, intensity / 2);
  }
}
