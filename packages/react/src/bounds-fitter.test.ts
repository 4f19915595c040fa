import { packCloud, type SceneFraming } from '@websplatter/core';
import { type FrameSplatsOptions, SplatData } from '@websplatter/three';
import { Group, OrthographicCamera, PerspectiveCamera, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { describe, expect, it, vi } from 'vitest';
import { BoundsFitter } from './bounds-fitter.ts';
import type { FittedCamera } from './fit-camera.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';

/** A statue in a park, y down. */
const FRAMING: SceneFraming = {
  kind: 'surrounded',
  position: [3, -2, 4],
  target: [1, 0, 0],
  up: [0, -1, 0],
  fovYDegrees: 50,
  center: [1, 0, 0],
  radius: 0.5,
  groundHeight: null,
  confidence: { up: 1, kind: 1 },
};

/** Splats on the edges of a cube of this half side: a sky. */
function sky(half: number): SplatData {
  const corners = Array.from({ length: 8 }, (_, i) =>
    [i & 1, i & 2, i & 4].map((bit) => (bit ? half : -half)),
  );
  const set = {
    count: 8,
    origin: [0, 0, 0] as const,
    positions: Float32Array.from(corners.flat()),
    logScales: new Float32Array(24).fill(-4),
    rotations: Float32Array.from({ length: 32 }, (_, i) => Number(i % 4 === 0)),
    opacityLogits: new Float32Array(8),
    colorDc: new Float32Array(24),
    harmonics: { degree: 0 as const, coefficients: new Float32Array(0) },
    fileIndices: Uint32Array.from({ length: 8 }, (_, i) => i),
    dropped: {},
  };
  return new SplatData(packCloud(set, { geometryPrecision: 'packed', shPrecision: 'u8' }));
}

/** A fitter of a cloud in a group, whose answers come when the test gives them. */
function fitterOf(camera: FittedCamera, controls: object | null = null) {
  const group = new Group();
  group.add(new SplatCloudObject(sky(100)));
  const asked: { options: FrameSplatsOptions; answer: (framing: SceneFraming | Error | null) => void }[] = [];
  const invalidate = vi.fn();
  const fitter = new BoundsFitter({
    group: () => group,
    camera: () => camera,
    controls: () => controls,
    frame: (_group, _camera, options) =>
      new Promise((resolve, reject) => {
        const answer = (framing: SceneFraming | Error | null) =>
          framing instanceof Error ? reject(framing) : resolve(framing);
        asked.push({ options, answer });
      }),
    invalidate,
  });
  return { fitter, group, asked, invalidate };
}

/** As react-three-fiber makes it. */
function defaultCamera(): PerspectiveCamera {
  const camera = new PerspectiveCamera(50, 1, 0.1, 1000);
  camera.position.z = 5;
  return camera;
}

const rounded = (vector: Vector3) => vector.toArray().map((value) => Math.round(value * 1e6) / 1e6 + 0);

describe('the first fit', () => {
  it('places a camera that nobody has placed as the scene wants, and controls with it', async () => {
    const camera = defaultCamera();
    const controls = new OrbitControls(camera);
    controls.update();
    const { fitter, asked, invalidate } = fitterOf(camera, controls);
    const { isFitted, framed } = fitter.fitLoaded(1);
    // At once, all of it, in the camera's direction.
    expect(isFitted).toBe(true);
    expect(camera.position.z).toBeGreaterThan(200);
    expect(asked[0].options.up).toBeUndefined();
    controls.update();
    invalidate.mockClear();
    asked[0].answer(FRAMING);
    expect(await framed).toBe(true);
    expect(fitter.framing).toBe(FRAMING);
    controls.update();
    expect(rounded(camera.position)).toEqual([3, -2, 4]);
    expect(camera.up.toArray()).toEqual([0, -1, 0]);
    expect(rounded(controls.target)).toEqual([1, 0, 0]);
    expect(invalidate).toHaveBeenCalled();
    // Controls keep the scene's up upright: a turn leaves the height as it is.
    Object.assign(controls, { autoRotate: true });
    controls.update();
    expect(camera.position.y).toBeCloseTo(-2, 6);
    expect(camera.position.x).not.toBeCloseTo(3, 4);
  });

  it('keeps the direction of a camera that the application has placed, about the detail', async () => {
    const camera = defaultCamera();
    camera.position.set(3, 0, 0);
    camera.lookAt(0, 0, 0);
    const { fitter, asked } = fitterOf(camera);
    const { framed } = fitter.fitLoaded(1);
    asked[0].answer(FRAMING);
    expect(await framed).toBe(true);
    expect(rounded(camera.getWorldDirection(new Vector3()))).toEqual([-1, 0, 0]);
    const distance = 0.5 + 0.5 / Math.tan(Math.PI / 7.2);
    expect(rounded(camera.position)).toEqual([expect.closeTo(1 + distance, 5), 0, 0]);
    // The sky is not cut off.
    expect(camera.far).toBeGreaterThan(170);
    expect(camera.up.toArray()).toEqual([0, 1, 0]);
  });

  it('takes an up of the application’s own for the scene’s', () => {
    const camera = defaultCamera();
    camera.up.set(0, 0, 1);
    const { fitter, asked } = fitterOf(camera);
    fitter.fitLoaded(1);
    expect(asked[0].options.up?.toArray()).toEqual([0, 0, 1]);
  });

  it.each([
    ['has moved it', (camera: FittedCamera) => void camera.position.setX(7)],
    ['has turned it', (camera: FittedCamera) => void camera.rotateY(0.1)],
    ['has begun to', (_: FittedCamera, controls: OrbitControls) => controls.dispatchEvent({ type: 'start' })],
  ] as const)('leaves the camera to a person who %s meanwhile', async (_, move) => {
    const camera = defaultCamera();
    const controls = new OrbitControls(camera);
    const { fitter, asked } = fitterOf(camera, controls);
    const { framed } = fitter.fitLoaded(1);
    move(camera, controls);
    const pose = camera.matrix.compose(camera.position, camera.quaternion, camera.scale).clone();
    asked[0].answer(FRAMING);
    expect(await framed).toBe(true);
    expect(camera.matrix.compose(camera.position, camera.quaternion, camera.scale)).toEqual(pose);
    expect(fitter.framing).toBe(FRAMING);
  });

  it('places a camera that rotates by itself', async () => {
    const camera = defaultCamera();
    const controls = Object.assign(new OrbitControls(camera), { autoRotate: true });
    const { fitter, asked } = fitterOf(camera, controls);
    const { framed } = fitter.fitLoaded(1);
    controls.update();
    asked[0].answer(FRAMING);
    await framed;
    expect(rounded(controls.target)).toEqual([1, 0, 0]);
  });

  /**
   * @fault three.js and React: the camera moves, another cloud loads, the component unmounts or the GPU
   *   fails while `<SplatBounds>` looks for the first view
   * @consequence a moved camera stays; the search restarts for all clouds, or ends; without an answer the
   *   bounds stay fitted
   */
  it('begins anew for clouds that come before the answer', async () => {
    const camera = defaultCamera();
    const { fitter, asked } = fitterOf(camera);
    const first = fitter.fitLoaded(1);
    expect(fitter.isFraming).toBe(true);
    fitter.forget();
    expect(asked[0].options.signal?.aborted).toBe(true);
    const second = fitter.fitLoaded(1);
    asked[0].answer(FRAMING);
    expect(await first.framed).toBe(false);
    asked[1].answer(FRAMING);
    expect(await second.framed).toBe(true);
    expect(fitter.isFraming).toBe(false);
    expect(rounded(camera.position)).toEqual([3, -2, 4]);
    // That up was no application's.
    fitter.fitLoaded(1);
    expect(asked[2].options.up).toBeUndefined();
  });

  it('is by the bounds alone where nothing can be found, which is told unless it was ended', async () => {
    const warn = vi.spyOn(console, 'warn').mockReturnValue();
    const camera = defaultCamera();
    const { fitter, asked } = fitterOf(camera);
    for (const answer of [null, new DOMException('ended', 'AbortError'), new Error('no memory')]) {
      const { isFitted, framed } = fitter.fitLoaded(1);
      asked.at(-1)!.answer(answer);
      expect([isFitted, await framed, fitter.framing]).toEqual([true, false, null]);
    }
    expect(warn).toHaveBeenCalledExactlyOnceWith(new Error('no memory'));
    warn.mockRestore();
  });

  it('waits for a cloud', async () => {
    const { fitter, group, asked } = fitterOf(defaultCamera());
    group.clear();
    const { isFitted, framed } = fitter.fitLoaded(1);
    expect([isFitted, await framed, asked.length]).toEqual([false, false, 0]);
  });
});

describe('when asked for', () => {
  it('a framing places any camera, and rejects once the component is gone', async () => {
    const camera = new OrthographicCamera(-1, 1, 1, -1, 0.1, 1000);
    camera.position.set(1, 2, 3);
    const { fitter, asked } = fitterOf(camera);
    const framed = fitter.frame();
    asked[0].answer(FRAMING);
    expect(await framed).toBe(FRAMING);
    expect(rounded(camera.position)).toEqual([3, -2, 4]);
    const late = fitter.frame();
    fitter.end();
    asked[1].answer(FRAMING);
    await expect(late).rejects.toThrow('abort');
  });

  it('a fit is about the detail of a place, which moves with its group', async () => {
    const camera = defaultCamera();
    const { fitter, group, asked } = fitterOf(camera);
    const framed = fitter.frame();
    asked[0].answer(FRAMING);
    await framed;
    group.position.set(0, 5, 0);
    group.scale.setScalar(2);
    fitter.fit(1);
    const middle = new Vector3(2, 5, 0);
    expect(middle.clone().project(camera).x).toBeCloseTo(0, 6);
    expect(camera.position.distanceTo(middle)).toBeLessThan(5);
    // An object is shown as a whole.
    const whole = fitter.frame();
    asked[1].answer({ ...FRAMING, kind: 'object' });
    await whole;
    fitter.fit(1);
    expect(camera.position.length()).toBeGreaterThan(300);
  });
});
