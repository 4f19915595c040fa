import { encodePly, WebGpuUnavailableError } from '@websplatter/core';
import { PerspectiveCamera, Raycaster, Scene, Vector3 } from 'three/webgpu';
import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { frameSplats } from './cloud/frame-splats.ts';
import { SplatCloudObject } from './cloud/splat-cloud-object.ts';
import { SplatLoader } from './cloud/splat-loader.ts';
import { SplatsUnsupportedRendererError } from './errors.ts';
import { adoptRenderer, findSplatEngine, onDeviceLost, splatDetailOf } from './renderer/adopt-renderer.ts';
import { createSplatRenderer, isSupported } from './renderer/create-splat-renderer.ts';
import { splatSetAt } from './testing/test-clouds.ts';
import { installNullRenderer } from './testing.ts';

const file = new File([encodePly(splatSetAt([0, 0, 0], [1, 2, 3])) as Uint8Array<ArrayBuffer>], 'two.ply');
let uninstall = () => {};

beforeEach(() => {
  uninstall = installNullRenderer();
});
afterEach(() => uninstall());

describe('the null renderer', () => {
  test('has splats read, placed, reported and freed, and draws nothing', async () => {
    const renderer = await createSplatRenderer({ detail: 'auto' });
    expect(splatDetailOf(renderer)).toBe('auto');
    renderer.setSize(300, 200);
    renderer.setPixelRatio(2);
    expect([renderer.domElement.width, renderer.domElement.height]).toEqual([600, 400]);
    const data = await new SplatLoader().detectSupport(renderer).loadAsync(file);
    expect([data.count, data.name]).toEqual([2, 'two.ply']);

    const [scene, camera] = [new Scene(), new PerspectiveCamera()];
    const cloud = new SplatCloudObject(data);
    const told: string[] = [];
    for (const type of ['firstframe', 'complete'] as const)
      cloud.addEventListener(type, () => told.push(type));
    const hidden = new SplatCloudObject(data);
    hidden.opacity = 0;
    hidden.addEventListener('firstframe', () => told.push('hidden'));
    scene.add(cloud, hidden);
    cloud.position.x = 5;
    const render = async () => {
      renderer.render(scene, camera);
      await Promise.resolve();
    };
    await render();
    await render();
    expect(told).toEqual(['firstframe', 'complete']);
    expect(new Vector3().setFromMatrixPosition(cloud.matrixWorld).x).toBe(5);
    expect(cloud.worldBounds.max.toArray()).toEqual([6, 2, 3]);
    expect(await cloud.pick(renderer, camera, 10, 10)).toBeNull();
    cloud.dispose();
    cloud.data = null;
    await renderer.dispose();
  });

  test('lets rays hit splats in memory', async () => {
    const data = await new SplatLoader().loadAsync(file);
    const cloud = new SplatCloudObject(data);
    cloud.updateMatrixWorld();
    await data.prepareRays();
    const hits = new Raycaster(new Vector3(0, 0, 9), new Vector3(0, 0, -1)).intersectObject(cloud);
    expect(hits).toHaveLength(1);
    expect(hits[0].distance).toBeCloseTo(9, 1);
  });

  test('has no engine, and says so', async () => {
    const renderer = await createSplatRenderer();
    expect(await isSupported()).toBe(true);
    expect(findSplatEngine(renderer)).toBeNull();
    await expect(adoptRenderer(renderer)).rejects.toThrow(WebGpuUnavailableError);
    await expect(frameSplats(renderer, new Scene(), new PerspectiveCamera())).rejects.toThrow(
      'draws nothing',
    );
    expect(onDeviceLost(renderer, () => {})).toBeTypeOf('function');
  });
});

test('a renderer of any kind draws nothing once it gets splats', async () => {
  const render = vi.fn();
  const renderer = { render, isWebGLRenderer: true };
  expect(findSplatEngine(renderer)).toBeNull();
  renderer.render(new Scene(), new PerspectiveCamera());
  expect(render).not.toHaveBeenCalled();
});

/**
 * @fault three.js and React: tests install the null renderer
 * @consequence renderers made without it are refused as in every page
 */
test('other renderers are refused before it is installed and after it has ended', async () => {
  uninstall();
  expect(await isSupported(undefined)).toBe(false);
  const refused = () => findSplatEngine({ isWebGLRenderer: true });
  expect(refused).toThrow(SplatsUnsupportedRendererError);
  expect(refused).toThrow('this is three’s WebGLRenderer');
  await expect(createSplatRenderer()).rejects.toThrow(WebGpuUnavailableError);
});
