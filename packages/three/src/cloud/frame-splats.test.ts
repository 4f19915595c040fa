import { frameScene, type SceneFraming } from '@websplatter/core';
import { Group, OrthographicCamera, PerspectiveCamera, Scene, Vector3 } from 'three/webgpu';
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { attachEngine } from '../renderer/adopt-renderer.ts';
import { fakeEngine } from '../testing/fake-engine.ts';
import { fakeRenderer } from '../testing/fake-renderer.ts';
import { splatDataAt } from '../testing/test-clouds.ts';
import { frameSplats, placeCamera } from './frame-splats.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';
import { SplatInstances } from './splat-instances.ts';

vi.mock('@websplatter/core', { spy: true });

const FRAMING: SceneFraming = {
  kind: 'object',
  position: [1, 2, 8],
  target: [1, 2, 3],
  up: [0, -1, 0],
  fovYDegrees: 50,
  center: [1, 2, 3],
  radius: 2,
  groundHeight: null,
  confidence: { up: 1, kind: 1 },
};

const framed = vi.mocked(frameScene);
beforeEach(() => void framed.mockReset().mockResolvedValue(FRAMING));

/** A renderer with an engine. */
function rendererWithEngine() {
  const renderer = fakeRenderer().renderer;
  Object.assign(renderer, { dispose: () => {} });
  const engine = fakeEngine();
  attachEngine(renderer, engine.engine, 'full');
  return { renderer, ...engine };
}

describe('frameSplats', () => {
  it('frames the visible clouds below an object, where they are in the world, for the camera', async () => {
    const { renderer, cloud, destroyed } = rendererWithEngine();
    const [scene, group] = [new Scene(), new Group()];
    const [object, hidden, outside] = [0, 1, 2].map(() => new SplatCloudObject(splatDataAt([0, 0, 0])));
    object.opacity = 0.5;
    object.instances = new SplatInstances(2);
    hidden.visible = false;
    group.position.set(5, 0, 0);
    group.scale.setScalar(2);
    object.position.set(1, 0, 0);
    scene.add(group.add(object, hidden, new SplatCloudObject()), outside);
    const { signal } = new AbortController();
    const camera = new PerspectiveCamera(40, 1.5);
    const options = { up: new Vector3(0, 0, 3), kind: 'enclosed', signal } as const;
    expect(await frameSplats(renderer, group, camera, options)).toBe(FRAMING);
    const modelMatrix = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 7, 0, 0, 1];
    const instances = { modelMatrices: expect.objectContaining({ length: 32 }) };
    expect(framed).toHaveBeenCalledExactlyOnceWith([{ cloud, modelMatrix, instances, opacity: 0.5 }], {
      aspect: 1.5,
      fovYDegrees: expect.closeTo(40, 9),
      up: [0, 0, 3],
      kind: 'enclosed',
      signal,
    });
    // The upload is there for the frame that follows.
    expect(destroyed).not.toHaveBeenCalled();
    object.dispose();
    expect(destroyed).toHaveBeenCalledOnce();
  });

  it('takes the shape of orthographic images, and of a zoomed camera', async () => {
    const { renderer } = rendererWithEngine();
    await frameSplats(renderer, new Scene(), new OrthographicCamera(-3, 1, 1, -1));
    expect(framed.mock.lastCall![1]).toMatchObject({ aspect: 2, fovYDegrees: 50, up: undefined });
    const zoomed = new PerspectiveCamera(90, 2);
    zoomed.zoom = 2;
    await frameSplats(renderer, new Scene(), zoomed);
    expect(framed.mock.lastCall![1]!.fovYDegrees).toBeCloseTo(53.13, 2);
  });

  it('does nothing once its signal is aborted', async () => {
    const { renderer } = rendererWithEngine();
    const signal = AbortSignal.abort(new Error('unmounted'));
    await expect(frameSplats(renderer, new Scene(), new PerspectiveCamera(), { signal })).rejects.toThrow(
      'unmounted',
    );
    expect(framed).not.toHaveBeenCalled();
  });
});

describe('placeCamera', () => {
  it('places a camera wherever its parent is, upright, with planes that spare the scene', () => {
    const camera = new PerspectiveCamera(50, 1, 0.1, 100);
    const parent = new Group();
    parent.position.set(10, 0, 0);
    parent.rotation.set(0.3, 1, 0.2);
    parent.add(camera);
    placeCamera(camera, FRAMING);
    const rounded = (vector: Vector3) => vector.toArray().map((value) => Math.round(value * 1e6) / 1e6 + 0);
    expect(rounded(camera.getWorldPosition(new Vector3()))).toEqual([1, 2, 8]);
    expect(rounded(camera.getWorldDirection(new Vector3()))).toEqual([0, 0, -1]);
    expect(rounded(new Vector3(1, 5, 3).project(camera)).slice(0, 2)).toEqual([0, expect.closeTo(-1.287, 3)]);
    expect(camera.up.toArray()).toEqual([0, -1, 0]);
    expect([camera.near, camera.far]).toEqual([0.005, 50_000]);
    placeCamera(camera, { ...FRAMING, position: [1, 2, 4] });
    expect(camera.near).toBe(0.001);
    expect(camera.far).toBe(50_000);
  });

  it('zooms an orthographic camera to what the view has at the target', () => {
    const camera = new OrthographicCamera(-2, 2, 1, -1);
    placeCamera(camera, FRAMING);
    expect(camera.zoom).toBeCloseTo(1 / (5 * Math.tan((25 * Math.PI) / 180)), 9);
    expect(new Vector3(1, 2, 3).project(camera).x).toBeCloseTo(0, 9);
  });
});
