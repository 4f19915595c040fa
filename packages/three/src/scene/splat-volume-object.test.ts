import { InvalidArgumentError } from '@websplatter/core';
import { type Volume, volumes } from '@websplatter/core/effects';
import { Group, Object3D, PerspectiveCamera, Raycaster, Scene, Vector3 } from 'three/webgpu';
import { beforeAll, describe, expect, test, vi } from 'vitest';
import { SplatCloudObject } from '../cloud/splat-cloud-object.ts';
import { splatDataAt } from '../testing/test-clouds.ts';
import { SplatVolumeObject } from './splat-volume-object.ts';

const camera = new PerspectiveCamera();
const newCloud = () => new SplatCloudObject(splatDataAt([0, 0, 0]));

/** Volumes that act on a cloud, as it is drawn after an update of its scene. */
function volumesOn(cloud: SplatCloudObject, scene: Scene): readonly Volume[] {
  scene.updateMatrixWorld();
  const uses = cloud.effectsAt(0, scene, camera)!;
  return uses.flatMap(({ options }) => options as readonly Volume[]);
}

const namesOn = (cloud: SplatCloudObject, scene: Scene) =>
  volumesOn(cloud, scene).map(({ softEdge }) => softEdge);

/** A volume that tests know by its soft edge. */
const named = (softEdge: number) => new SplatVolumeObject({ softEdge });

// Its code is loaded once a scene has a volume.
beforeAll(async () => {
  const cloud = newCloud();
  const scene = new Scene().add(cloud, named(0));
  scene.updateMatrixWorld();
  await vi.waitUntil(() => cloud.effectsAt(0, scene, camera), 120_000);
});

describe('volumes of a scene', () => {
  test('act at their place in the world', () => {
    const cloud = newCloud();
    const volume = new SplatVolumeObject({ shape: 'sphere', mode: 'displace', offset: [0, 2, 0], radius: 3 });
    const group = new Group().add(volume);
    group.position.set(1, 2, 3);
    volume.scale.setScalar(0.5);
    const scene = new Scene().add(cloud, group);
    const [acting] = volumesOn(cloud, scene);
    expect(acting).toMatchObject({ shape: 'sphere', mode: 'displace', offset: [0, 2, 0], radius: 3 });
    expect(acting.matrix).toEqual([0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 1, 2, 3, 1]);
    group.position.x = 7;
    expect(volumesOn(cloud, scene)[0].matrix).toContain(7);
    // What was drawn before stays as it was.
    expect(acting.matrix).not.toContain(7);
  });

  test('act on the clouds below their nearest ancestor with clouds', () => {
    const [left, right, inner] = [newCloud(), newCloud(), newCloud()];
    const [ofScene, ofGroup, ofCloud, alone] = [1, 2, 3, 4].map(named);
    const group = new Group().add(right, ofGroup, new Group().add(alone));
    left.add(ofCloud);
    const scene = new Scene().add(left, group, ofScene);
    expect(namesOn(left, scene)).toEqual([3, 1]);
    expect(namesOn(right, scene)).toEqual([2, 4, 1]);
    alone.parent!.add(inner);
    expect(namesOn(right, scene)).toEqual([2, 1]);
    expect(namesOn(inner, scene)).toEqual([2, 4, 1]);
  });

  test('act in the order of the scene’s tree, wherever they were added', () => {
    const cloud = newCloud();
    const [first, below, second, third] = [1, 2, 3, 4].map(named);
    const scene = new Scene().add(third, cloud);
    scene.updateMatrixWorld();
    scene.add(second);
    scene.updateMatrixWorld();
    scene.children.unshift(first);
    first.parent = scene;
    first.add(below);
    expect(namesOn(cloud, scene)).toEqual([1, 2, 4, 3]);
  });

  test('do nothing while they are invisible, and after they have left', () => {
    const cloud = newCloud();
    const volume = named(1);
    const group = new Group().add(volume);
    const scene = new Scene().add(cloud, group);
    expect(namesOn(cloud, scene)).toEqual([1]);
    group.visible = false;
    expect(namesOn(cloud, scene)).toEqual([]);
    group.visible = true;
    group.remove(volume);
    expect(namesOn(cloud, scene)).toEqual([]);
    // In another scene.
    const other = newCloud();
    expect(namesOn(other, new Scene().add(other, volume))).toEqual([1]);
  });

  test('follow those of the cloud’s own effect', () => {
    const cloud = newCloud();
    cloud.effects = [volumes([{ shape: 'box', mode: 'keep', softEdge: 5 }])];
    const scene = new Scene().add(named(1), cloud);
    expect(namesOn(cloud, scene)).toEqual([5, 1]);
  });

  test('hide splats from rays', async () => {
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0], [0, 0, -2]));
    await cloud.data!.prepareRays();
    const scene = new Scene().add(cloud);
    scene.updateMatrixWorld();
    const ray = () => new Raycaster(new Vector3(0, 0, 5), new Vector3(0, 0, -1)).intersectObject(cloud)[0];
    const near = ray().distance;
    scene.add(new SplatVolumeObject({ shape: 'sphere' }));
    scene.updateMatrixWorld();
    expect(ray().distance).toBeCloseTo(near + 2, 1);
  });
});

describe('a volume', () => {
  test('is cloned with its properties', () => {
    const parameters = { shape: 'capsule', mode: 'tint', tint: 'red', height: 3, invert: true } as const;
    expect(new SplatVolumeObject(parameters).clone()).toMatchObject(parameters);
  });

  test('takes any of three’s colours, and numbers that a spring has overshot', () => {
    const tinting = new SplatVolumeObject({ mode: 'tint', tint: 'red' });
    expect(tinting.toVolume()).toMatchObject({ tint: [1, 0, 0] });
    Object.assign(tinting, {
      tint: [2, -0.1, 0],
      radius: -1,
      softEdge: -0.1,
      opacity: 1.1,
      size: [-1, 1, 1],
    });
    expect(tinting.toVolume()).toMatchObject({
      tint: [2, 0, 0],
      radius: 0,
      softEdge: 0,
      opacity: 1,
      size: [0, 1, 1],
    });
  });

  test('that is invalid is named by the clouds’ error', () => {
    const cloud = newCloud();
    const scene = new Scene().add(cloud, named(1), named(Number.NaN));
    expect(() => volumesOn(cloud, scene)).toThrow(InvalidArgumentError);
    expect(() => volumesOn(cloud, scene)).toThrow('volumes[1].softEdge is NaN');
    for (const [name, value] of Object.entries({
      tint: null,
      mode: 'erase',
      size: 3,
      offset: 'up',
      shape: 0,
    })) {
      const volume = Object.assign(new SplatVolumeObject({ mode: 'tint' }), { [name]: value });
      if (name === 'offset') volume.mode = 'displace';
      const other = new Scene().add(new Object3D(), cloud, volume);
      expect(() => volumesOn(cloud, other), name).toThrow(InvalidArgumentError);
    }
  });
});
