import { Group, Mesh, PerspectiveCamera, Scene, Vector3 } from 'three/webgpu';
import { describe, expect, test, vi } from 'vitest';
import { SplatsUnsupportedRendererError } from './errors.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';
import { SplatLayer } from './splat-layer.ts';
import { splatDataAt } from './testing/test-clouds.ts';

function layersOf(root: Group | Scene): SplatLayer[] {
  return root.children.filter((child) => child instanceof SplatLayer);
}

function placeOf(layer: SplatLayer): number[] {
  return new Vector3().setFromMatrixPosition(layer.matrixWorld).toArray();
}

function cloudAt(...place: [number, number, number]): SplatCloudObject {
  return new SplatCloudObject(splatDataAt(place));
}

describe('the layer of a scene', () => {
  test('is shared by all clouds, however deep, and lies in their middle', () => {
    const scene = new Scene();
    const group = new Group();
    group.position.x = 10;
    group.add(cloudAt(0, 0, 0));
    scene.add(cloudAt(0, 4, 0), group);
    scene.updateMatrixWorld();
    scene.updateMatrixWorld();
    expect(layersOf(scene)).toHaveLength(1);
    expect(placeOf(layersOf(scene)[0])).toEqual([5, 2, 0]);
    group.position.x = 20;
    scene.updateMatrixWorld();
    expect(placeOf(layersOf(scene)[0])).toEqual([10, 2, 0]);
  });

  test('leaves with the last cloud', async () => {
    const scene = new Scene();
    const [first, second] = [cloudAt(0, 0, 0), cloudAt(2, 0, 0)];
    scene.add(first, second);
    scene.updateMatrixWorld();
    first.removeFromParent();
    expect(layersOf(scene)).toHaveLength(1);
    expect(placeOf(layersOf(scene)[0])).toEqual([2, 0, 0]);
    second.dispose();
    await Promise.resolve();
    expect(layersOf(scene)).toEqual([]);
  });

  test('changes when a cloud moves to another scene', async () => {
    const [from, to] = [new Scene(), new Scene()];
    const cloud = cloudAt(0, 0, 0);
    from.add(cloud);
    from.updateMatrixWorld();
    to.add(cloud);
    to.updateMatrixWorld();
    await Promise.resolve();
    expect(layersOf(from)).toEqual([]);
    expect(layersOf(to)).toHaveLength(1);
  });

  test('replaces that of a group that is added to it, even while three traverses the group', async () => {
    const group = new Group();
    group.add(cloudAt(0, 0, 0));
    group.updateMatrixWorld();
    expect(layersOf(group)).toHaveLength(1);
    const scene = new Scene();
    scene.add(group);
    scene.updateMatrixWorld();
    await Promise.resolve();
    expect(layersOf(group)).toEqual([]);
    expect(layersOf(scene)).toHaveLength(1);
  });

  test('stays if its only cloud is removed and added again', async () => {
    const scene = new Scene();
    const cloud = cloudAt(0, 0, 0);
    scene.add(cloud);
    scene.updateMatrixWorld();
    const [layer] = layersOf(scene);
    scene.remove(cloud);
    scene.add(cloud);
    scene.updateMatrixWorld();
    await Promise.resolve();
    expect(layersOf(scene)).toEqual([layer]);
  });

  test('comes back after the scene was cleared', () => {
    const scene = new Scene();
    const cloud = cloudAt(0, 0, 0);
    scene.add(cloud);
    scene.updateMatrixWorld();
    scene.clear();
    scene.add(cloud);
    scene.updateMatrixWorld();
    expect(layersOf(scene)).toHaveLength(1);
  });

  test('is not made by a cloud outside of a scene', () => {
    const cloud = cloudAt(0, 0, 0);
    cloud.updateMatrixWorld();
    expect(cloud.children).toEqual([]);
  });

  test('is another for another render order', async () => {
    const scene = new Scene();
    const [first, second] = [cloudAt(0, 0, 0), cloudAt(2, 0, 0)];
    scene.add(first, second);
    scene.updateMatrixWorld();
    second.renderOrder = -1;
    scene.updateMatrixWorld();
    const layers = layersOf(scene);
    expect(layers.map(({ renderOrder }) => renderOrder)).toEqual([0, -1]);
    expect(layers.map(placeOf)).toEqual([
      [0, 0, 0],
      [2, 0, 0],
    ]);
    second.renderOrder = 0;
    scene.updateMatrixWorld();
    await Promise.resolve();
    expect(layersOf(scene)).toEqual([layers[0]]);
    expect(placeOf(layers[0])).toEqual([1, 0, 0]);
  });

  test('has the render order of its clouds, and writes depth if one does', async () => {
    const scene = new Scene();
    const clouds = [cloudAt(0, 0, 0), cloudAt(2, 0, 0)];
    for (const cloud of clouds) cloud.renderOrder = 3;
    scene.add(...clouds);
    scene.updateMatrixWorld();
    const [layer] = layersOf(scene);
    const depthMesh = layer.children[0] as Mesh;
    expect(depthMesh).toBeInstanceOf(Mesh);
    expect([layer.renderOrder, depthMesh.renderOrder, depthMesh.visible]).toEqual([3, 3, false]);
    clouds[1].depthWrite = true;
    scene.updateMatrixWorld();
    await expect.poll(() => depthMesh.visible).toBe(true);
    expect(depthMesh.material).not.toBe(layer.material);
  });
});

describe('a renderer that cannot draw splats', () => {
  function drawWith(renderer: object, scene: Scene): void {
    const [layer] = layersOf(scene);
    layer.onBeforeRender(renderer, scene, new PerspectiveCamera());
  }

  test('is reported once, to all clouds with a listener', () => {
    const scene = new Scene();
    const clouds = [cloudAt(0, 0, 0), cloudAt(2, 0, 0)];
    scene.add(...clouds);
    scene.updateMatrixWorld();
    const listeners = clouds.map((cloud) => {
      cloud.onError = vi.fn();
      return cloud.onError;
    });
    drawWith({}, scene);
    drawWith({}, scene);
    for (const listener of listeners) {
      expect(listener).toHaveBeenCalledTimes(1);
      expect(listener).toHaveBeenCalledWith(expect.any(SplatsUnsupportedRendererError));
    }
  });

  test('is logged once without listeners', () => {
    const scene = new Scene();
    scene.add(cloudAt(0, 0, 0));
    scene.updateMatrixWorld();
    const log = vi.spyOn(console, 'error').mockImplementation(() => {});
    drawWith({}, scene);
    drawWith({}, scene);
    expect(log).toHaveBeenCalledTimes(1);
    log.mockRestore();
  });

  test('throws at once if it is a WebGLRenderer, which would fail at the layer’s material', () => {
    const scene = new Scene();
    const cloud = cloudAt(0, 0, 0);
    cloud.onError = () => {};
    scene.add(cloud);
    scene.updateMatrixWorld();
    expect(() => drawWith({ isWebGLRenderer: true }, scene)).toThrow(/createSplatRenderer/);
  });

  test('is not used for passes that are about meshes', () => {
    const scene = new Scene();
    const cloud = cloudAt(0, 0, 0);
    cloud.onError = vi.fn();
    scene.add(cloud);
    scene.updateMatrixWorld();
    scene.overrideMaterial = layersOf(scene)[0].material;
    drawWith({}, scene);
    expect(cloud.onError).not.toHaveBeenCalled();
  });
});
