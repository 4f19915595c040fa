import { InvalidArgumentError } from '@websplatter/core';
import { type RelightOptions, relight } from '@websplatter/core/effects';
import {
  AmbientLight,
  Color,
  DirectionalLight,
  Group,
  HemisphereLight,
  type Light,
  LightProbe,
  PerspectiveCamera,
  PointLight,
  RectAreaLight,
  Scene,
  SpotLight,
  Texture,
} from 'three/webgpu';
import { describe, expect, test, vi } from 'vitest';
import { SplatCloudObject } from '../cloud/splat-cloud-object.ts';
import { sceneRelight } from './scene-relight.ts';

/** Returns the options of the light of a scene. */
function optionsOf(scene: Scene, strength = 1): RelightOptions {
  scene.updateMatrixWorld();
  const [use, ...others] = sceneRelight(scene, strength, []);
  expect(use.effect).toBe(relight.effect);
  expect(others).toEqual([]);
  return use.options as RelightOptions;
}

function sceneOf(...lights: Light[]): Scene {
  const scene = new Scene();
  scene.add(...lights);
  return scene;
}

describe('light of a scene', () => {
  test('sums ambient light and the environment', () => {
    const scene = sceneOf(new AmbientLight('red', 2), new AmbientLight(new Color(0, 0.5, 0), 1));
    expect(optionsOf(scene, 0.3)).toEqual({ ambient: [2, 0.5, 0], lights: [], strength: 0.3 });
    scene.environment = new Texture();
    scene.environmentIntensity = 0.5;
    const { ambient } = optionsOf(scene);
    expect(ambient).toEqual([2 + Math.PI / 2, 0.5 + Math.PI / 2, Math.PI / 2]);
  });

  test('has lights where they are, in linear colours times their intensities', () => {
    const sun = new DirectionalLight(new Color(1, 0.5, 0.25), 4);
    sun.position.set(0, 3, 0);
    sun.target.position.set(1, 0, 0);
    const lamp = new PointLight('white', 5, 7, 1.5);
    lamp.position.set(0, 0, 2);
    const spot = new SpotLight('white', 6, 8, 0.4, 0.2, 1);
    const rig = new Group();
    rig.position.set(10, 0, 0);
    rig.add(lamp);
    spot.target = lamp;
    const scene = sceneOf(sun, new HemisphereLight('white', new Color(0, 0, 0.5), 2));
    scene.add(sun.target, rig, spot);
    expect(optionsOf(scene).lights).toEqual([
      { kind: 'directional', irradiance: [4, 2, 1], direction: [1, -3, 0] },
      { kind: 'hemisphere', irradiance: [2, 2, 2], ground: [0, 0, 1], up: [0, 1, 0] },
      { kind: 'point', irradiance: [5, 5, 5], position: [10, 0, 2], decay: 1.5, distance: 7 },
      {
        kind: 'spot',
        irradiance: [6, 6, 6],
        position: [0, 1, 0],
        direction: [10, -1, 2],
        cone: { angle: 0.4, penumbra: 0.2, decay: 1, distance: 8 },
      },
    ]);
  });

  test('leaves out invisible lights and those of other kinds, and takes numbers that three takes', () => {
    const hidden = new Group();
    hidden.visible = false;
    hidden.add(new PointLight());
    const odd = new SpotLight('white', -1, -2, 3, 4, -5);
    odd.position.set(0, 0, 0);
    const scene = sceneOf(new RectAreaLight(), new LightProbe(), odd);
    scene.add(hidden);
    const { lights } = optionsOf(scene);
    expect(lights).toMatchObject([
      { kind: 'spot', irradiance: [0, 0, 0], direction: [0, 1, 0], cone: { penumbra: 1, decay: 0 } },
    ]);
  });

  test('is refused with more lights than the effect takes', () => {
    const scene = sceneOf(...Array.from({ length: 32 }, () => new PointLight()));
    expect(() => optionsOf(scene)).toThrow(InvalidArgumentError);
  });
});

describe('a cloud', () => {
  const camera = new PerspectiveCamera();

  test('is lit from the frame on for which code has been loaded, unless it has the effect of its own', async () => {
    const scene = sceneOf(new AmbientLight('white', 2));
    const cloud = new SplatCloudObject();
    scene.add(cloud);
    expect(cloud.effectsAt(0, scene, camera)).toEqual([]);
    cloud.relight = 0.5;
    const requested = vi.fn();
    cloud.addEventListener('needsframe', requested);
    await expect.poll(() => cloud.effectsAt(0, scene, camera)).not.toBeNull();
    expect(requested).toHaveBeenCalled();
    expect(cloud.effectsAt(0, scene, camera)).toMatchObject([
      { effect: relight.effect, options: { ambient: [2, 2, 2], strength: 0.5 } },
    ]);
    expect(cloud.clone()).toMatchObject({ relight: 0.5 });
    const own = relight({ ambient: [1, 1, 1] });
    cloud.effects = [own];
    expect(cloud.effectsAt(0, scene, camera)).toEqual([own]);
    Object.assign(cloud, { effects: [], relight: Number.NaN });
    expect(() => cloud.effectsAt(0, scene, camera)).toThrow(InvalidArgumentError);
  });
});
