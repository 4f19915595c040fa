import {
  type AccuracyChoice,
  DestroyedError,
  GpuLimitError,
  InvalidArgumentError,
  MOTION_SLOT,
  MOTION_VALUES,
  packCloud,
  resolveAccuracy,
  type SplatCloud,
  SplatSourceError,
} from '@websplatter/core';
import { brightness, fog, type RevealOptions, reveal, tint, volumes } from '@websplatter/core/effects';
import {
  Box3,
  ClippingGroup,
  Fog,
  Matrix4,
  Mesh,
  PerspectiveCamera,
  Plane,
  PlaneGeometry,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  type WebGPURenderer,
} from 'three/webgpu';
import { describe, expect, test, vi } from 'vitest';
import { SplatsPrecisionError } from '../errors.ts';
import { layersAround } from '../layer/splat-layer.ts';
import { fakeEngine } from '../testing/fake-engine.ts';
import { packedCloudAt, splatDataAt, splatSetAt } from '../testing/test-clouds.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';
import { SplatData } from './splat-data.ts';

describe('rays', () => {
  /** A cloud of one splat at x = 1. */
  async function cloudUnder(matrix: Matrix4): Promise<SplatCloudObject> {
    const cloud = new SplatCloudObject(splatDataAt([1, 0, 0]));
    cloud.matrixAutoUpdate = false;
    cloud.matrix.copy(matrix);
    cloud.updateMatrixWorld(true);
    await cloud.data!.prepareRays();
    return cloud;
  }

  /** A ray from z = 5 along −z. */
  const casterAt = (x: number, y = 0) => new Raycaster(new Vector3(x, y, 5), new Vector3(0, 0, -1));

  /** Splats at z = 0, −1 and −2, at x = 0 and x = 1. */
  async function rows(): Promise<SplatCloudObject> {
    const places = [0, -1, -2].flatMap((z) => [[0, 0, z] as const, [1, 0, z] as const]);
    const cloud = new SplatCloudObject(splatDataAt(...places));
    cloud.updateMatrixWorld(true);
    await cloud.data!.prepareRays();
    return cloud;
  }

  /** A splat at x = 0 that moves by 4 in the time from 0 to 1. */
  function movingData(): SplatData {
    const motion = new Float32Array(MOTION_VALUES);
    motion[MOTION_SLOT.logDuration] = 5;
    motion[MOTION_SLOT.velocity] = 4;
    return new SplatData(packCloud({ ...splatSetAt([0, 0, 0]), motion }, resolveAccuracy('reference')));
  }

  const isMet = (object: SplatCloudObject, x: number) => casterAt(x).intersectObject(object).length === 1;

  test('meet a moving scene at the time that each object shows', async () => {
    const data = movingData();
    const [first, later] = [new SplatCloudObject(data), new SplatCloudObject(data)];
    later.time = 0.5;
    await data.prepareRays();
    expect(isMet(first, 0)).toBe(true);
    await expect.poll(() => isMet(later, 2)).toBe(true);
    expect([isMet(first, 0), isMet(first, 2), isMet(later, 0)]).toEqual([true, false, false]);
    // Times after the last show it.
    later.time = 7;
    await expect.poll(() => isMet(later, 4)).toBe(true);
    later.time = null;
    await expect.poll(() => isMet(later, 0)).toBe(true);
  });

  test('meet a moving scene at the time that was prepared, or that of the object that starts it', async () => {
    const prepared = new SplatCloudObject(movingData());
    prepared.time = 0.5;
    await prepared.data!.prepareRays(0.5);
    expect([isMet(prepared, 0), isMet(prepared, 2)]).toEqual([false, true]);
    // The last call decides, whichever is ready first.
    await Promise.all([prepared.data!.prepareRays(0), prepared.data!.prepareRays(1)]);
    const later = new SplatCloudObject(prepared.data!);
    later.time = 1;
    expect([isMet(later, 0), isMet(later, 4)]).toEqual([false, true]);

    const unprepared = new SplatCloudObject(movingData());
    unprepared.time = 0.5;
    await expect.poll(() => isMet(unprepared, 2)).toBe(true);
  });

  test('of a canvas that has no size yet hit nothing', async () => {
    const cloud = await cloudUnder(new Matrix4());
    for (const aspect of [Number.NaN, 0, Number.POSITIVE_INFINITY]) {
      const camera = new PerspectiveCamera(50, aspect, 0.1, 100);
      camera.position.set(1, 0, 5);
      camera.updateMatrixWorld();
      const caster = new Raycaster();
      caster.setFromCamera(new Vector2(Number.NaN, Number.NaN), camera);
      expect(caster.intersectObject(cloud)).toEqual([]);
      // A ray of the application's own, which comes with that camera.
      caster.set(camera.position, new Vector3(0, 0, -1));
      expect(caster.intersectObject(cloud)).toHaveLength(1);
    }
  });

  const transforms = {
    identity: new Matrix4(),
    scaled: new Matrix4().makeScale(20, 0.5, 3),
    mirrored: new Matrix4().makeScale(-2, 1, 1),
    sheared: new Matrix4().makeShear(0.5, 0.3, 0.2, 0, 0.4, 0.1),
    'far away': new Matrix4().makeTranslation(100, -200, 300),
  };

  test.each(Object.entries(transforms))('hit a cloud that is %s at the right distance', async (_, matrix) => {
    const cloud = await cloudUnder(matrix);
    const center = new Vector3(1, 0, 0).applyMatrix4(matrix);
    const from = center.clone().add(new Vector3(3, 4, 12));
    const caster = new Raycaster(from, center.clone().sub(from).normalize());
    const [hit, ...others] = caster.intersectObject(cloud);
    expect(others).toEqual([]);
    expect(hit.object).toBe(cloud);
    expect(hit.distance).toBeCloseTo(from.distanceTo(hit.point), 9);
    expect(hit.distance).toBeCloseTo(13, 3);
    expect(caster.ray.distanceToPoint(hit.point)).toBeLessThan(1e-9);
  });

  test('miss clouds beside them, out of their range, and on other layers', async () => {
    const cloud = await cloudUnder(new Matrix4());
    expect(casterAt(0).intersectObject(cloud)).toEqual([]);
    const caster = casterAt(1);
    expect(caster.intersectObject(cloud)).toHaveLength(1);
    caster.far = 4;
    expect(caster.intersectObject(cloud)).toEqual([]);
    caster.far = 10;
    caster.near = 6;
    expect(caster.intersectObject(cloud)).toEqual([]);
    caster.near = 0;
    cloud.layers.set(3);
    expect(caster.intersectObject(cloud)).toEqual([]);
    caster.layers.enable(3);
    expect(caster.intersectObject(cloud)).toHaveLength(1);
  });

  test('pass splats nearer than they begin', async () => {
    const caster = casterAt(0);
    caster.near = 5.5;
    const [hit] = caster.intersectObject(await rows());
    expect(hit.distance).toBeCloseTo(6, 3);
  });

  test('of a camera hit the splats that it draws', async () => {
    const cloud = await rows();
    const camera = new PerspectiveCamera(50, 1, 5.5, 6.5);
    camera.position.z = 5;
    camera.updateMatrixWorld();
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2(0, 0), camera);
    expect(caster.intersectObject(cloud)[0].distance).toBeCloseTo(6, 3);
    camera.near = 0.1;
    expect(caster.intersectObject(cloud)[0].distance).toBeCloseTo(5, 3);
    camera.far = 4;
    expect(caster.intersectObject(cloud)).toEqual([]);
  });

  test('meet a mesh in front of splats first, and one behind them last', async () => {
    const cloud = await rows();
    const meshes = [0.5, -3].map((z) => {
      const mesh = new Mesh(new PlaneGeometry(9, 9));
      // Not met on the diagonal, which is in both triangles.
      mesh.position.set(0.5, 0, z);
      mesh.updateMatrixWorld();
      return mesh;
    });
    const hits = casterAt(0).intersectObjects([cloud, ...meshes]);
    expect(hits.map(({ object }) => object)).toEqual([meshes[0], cloud, meshes[1]]);
  });

  test('hit no cloud without data, extent or opacity', async () => {
    const caster = casterAt(1);
    expect(caster.intersectObject(new SplatCloudObject())).toEqual([]);
    expect(caster.intersectObject(await cloudUnder(new Matrix4().makeScale(1, 1, 0)))).toEqual([]);
    const cloud = await cloudUnder(new Matrix4());
    cloud.opacity = 0.5;
    expect(caster.intersectObject(cloud)).toEqual([]);
  });

  const box = { shape: 'box', mode: 'keep', center: [0, 0, -1], size: [1, 1, 1] } as const;
  const turned = { ...box, size: [1, 0.1, 9], rotation: [0, Math.SQRT1_2, 0, Math.SQRT1_2] } as const;
  const sphere = { shape: 'sphere', mode: 'keep', center: [0, 0, 0], radius: 0.5 } as const;
  const plane = { shape: 'plane', mode: 'keep', point: [0, 0, -1.5], normal: [0, 0, -2] } as const;

  test.each([
    ['inside a box', [box], 6],
    ['inside a turned box, which another covers', [turned, box], 6],
    ['outside a sphere', [{ ...sphere, mode: 'hide' }], 6],
    ['inside a sphere', [sphere], 5],
    ['behind a plane', [plane], 7],
    ['on the other side of it', [{ ...plane, mode: 'hide' }], 5],
  ] as const)('hit what volumes leave %s', async (_, list, distance) => {
    const cloud = await rows();
    cloud.effects = [volumes(list)];
    expect(casterAt(0).intersectObject(cloud)[0].distance).toBeCloseTo(distance, 3);
    cloud.effects = [volumes([...list, { ...sphere, radius: 0.1, center: [9, 9, 9] }])];
    expect(casterAt(0).intersectObject(cloud)).toEqual([]);
  });

  test('miss splats that have not appeared yet', async () => {
    const cloud = await rows();
    cloud.effects = [reveal({ from: [0, 0, -2], radius: 0.9 })];
    expect(casterAt(0).intersectObject(cloud)[0].distance).toBeCloseTo(7, 3);
    cloud.effects = [reveal({ from: 'camera', radius: 4 })];
    expect(casterAt(0).intersectObject(cloud)).toEqual([]);
    cloud.effects = [];
    cloud.reveal = { from: 'camera', durationMs: 1000 };
    expect(casterAt(0).intersectObject(cloud)).toEqual([]);
  });

  test('miss until they are prepared, which the first ray begins', async () => {
    const cloud = new SplatCloudObject(splatDataAt([1, 0, 0]));
    const caster = casterAt(1);
    expect(caster.intersectObject(cloud)).toEqual([]);
    await expect.poll(() => caster.intersectObject(cloud)).toHaveLength(1);
  });

  /**
   * @fault GPU memory: the tree that rays are tested against finds no room
   * @consequence the first ray calls `onError`, or writes to the console, once; later rays try again
   */
  test.each(['onError', 'the console'])('tell %s once why they miss, and try again', async (where) => {
    const lack = new GpuLimitError('memory', 24, 0, 'The tree of garden needs memory.');
    const data = splatDataAt([1, 0, 0]);
    const prepareRays = vi.spyOn(data, 'prepareRays').mockRejectedValue(lack);
    const told = vi.spyOn(console, 'error').mockImplementation(() => {});
    const cloud = new SplatCloudObject(data);
    if (where === 'onError') cloud.onError = told;
    casterAt(1).intersectObject(cloud);
    await expect.poll(() => told).toHaveBeenCalledExactlyOnceWith(lack);
    casterAt(1).intersectObject(cloud);
    expect(prepareRays).toHaveBeenCalledTimes(2);
    await new Promise((resolve) => setImmediate(resolve));
    expect(told).toHaveBeenCalledOnce();
    prepareRays.mockRestore();
    await expect.poll(() => casterAt(1).intersectObject(cloud)).toHaveLength(1);
    told.mockRestore();
  });

  test('are not prepared by frames', async () => {
    const cloud = new SplatCloudObject(splatDataAt([1, 0, 0]));
    const prepareRays = vi.spyOn(cloud.data!, 'prepareRays');
    const drawn = new Promise((resolve) => cloud.addEventListener('firstframe', resolve));
    cloud.announceDrawn(0, []);
    await drawn;
    expect(prepareRays).not.toHaveBeenCalled();
  });

  test('cannot be prepared for splats that have been freed, and can once these are back', async () => {
    const { engine, load } = fakeEngine();
    load.mockResolvedValue(Object.assign(fakeEngine().cloud, packedCloudAt([1, 0, 0])));
    const data = new SplatData(packedCloudAt([1, 0, 0]), 'garden', 'https://a.test/garden.ply');
    data.acquire(engine, engine);
    data.release(engine);
    await expect(data.prepareRays()).rejects.toThrow(DestroyedError);
    data.acquire(engine, engine);
    await data.prepareRays();
    const cloud = new SplatCloudObject(data);
    expect(casterAt(1).intersectObject(cloud)).toHaveLength(1);
  });
});

describe('numbers', () => {
  test('beyond their range count as the nearest in it, which is said once of each', () => {
    const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
    const cloud = new SplatCloudObject();
    const opacities = [0.5, 1.0015, -0.002, 1e9].map((opacity) => {
      cloud.opacity = opacity;
      return cloud.drawnOpacity;
    });
    expect(opacities).toEqual([0.5, 1, 0, 1]);
    expect(warn.mock.calls).toEqual([[expect.stringMatching(/^opacity .* 1\.0015, beyond 0…1\./)]]);
    cloud.reveal = { from: [0, 0, 0], radius: -0.1, softEdge: -0.2 };
    expect(cloud.effectsAt(0, new Scene(), new PerspectiveCamera())).toMatchObject([
      { options: { radius: 0, softEdge: 0 } },
    ]);
    expect(warn).toHaveBeenCalledTimes(2);
    expect(Object.assign(new SplatCloudObject(), { opacity: 2 }).drawnOpacity).toBe(1);
    expect(warn, 'of another cloud').toHaveBeenCalledTimes(3);
    expect(Object.assign(new SplatCloudObject(), { fade: -0.1 }).drawnFade).toBe(0);
    expect(warn, 'of another property').toHaveBeenCalledTimes(4);
    expect(Object.assign(new SplatCloudObject(), { relight: 1.2 }).drawnRelight).toBe(1);
    expect(warn, 'of light').toHaveBeenCalledTimes(5);
    warn.mockRestore();
  });

  test('that are none are refused by the frame, and rays miss', async () => {
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
    cloud.updateMatrixWorld();
    await cloud.data!.prepareRays();
    const ray = new Raycaster(new Vector3(0, 0, 5), new Vector3(0, 0, -1));
    expect(ray.intersectObject(cloud)).toHaveLength(1);
    cloud.fade = 0.01;
    expect(ray.intersectObject(cloud), 'a cloud that fades').toHaveLength(1);
    cloud.fade = 0;
    expect(ray.intersectObject(cloud), 'a cloud that has faded').toEqual([]);
    cloud.fade = 1;
    cloud.opacity = Number.NaN;
    expect(cloud.drawnOpacity).toBeNaN();
    expect(ray.intersectObject(cloud)).toEqual([]);
    cloud.opacity = 1;
    cloud.reveal = { from: 'camera', radius: Number.NaN };
    expect(() => cloud.effectsAt(0, new Scene(), new PerspectiveCamera())).toThrow(InvalidArgumentError);
    expect(ray.intersectObject(cloud)).toEqual([]);
  });
});

describe('data', () => {
  test('requests a frame when it changes', () => {
    const cloud = new SplatCloudObject();
    const needsFrame = vi.fn();
    cloud.addEventListener('needsframe', needsFrame);
    const data = splatDataAt([0, 0, 0]);
    cloud.data = data;
    cloud.data = data;
    expect(needsFrame).toHaveBeenCalledTimes(1);
  });

  test('is uploaded once per engine and freed with its last user', () => {
    const { engine, addPacked, destroyed } = fakeEngine();
    const data = splatDataAt([0, 0, 0]);
    const clouds = [new SplatCloudObject(data), new SplatCloudObject(data)];
    for (const cloud of clouds) {
      cloud.uploadedTo(engine);
      cloud.uploadedTo(engine);
    }
    expect(addPacked).toHaveBeenCalledTimes(1);
    clouds[0].dispose();
    clouds[0].dispose();
    expect(destroyed).not.toHaveBeenCalled();
    clouds[1].data = null;
    expect(destroyed).toHaveBeenCalledTimes(1);
    expect(clouds[1].uploadedTo(engine)).toBeNull();
  });

  test('is uploaded to each engine that draws it', () => {
    const [first, second] = [fakeEngine(), fakeEngine()];
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
    cloud.uploadedTo(first.engine);
    cloud.uploadedTo(second.engine);
    cloud.dispose();
    expect(first.destroyed).toHaveBeenCalledTimes(1);
    expect(second.destroyed).toHaveBeenCalledTimes(1);
  });

  test('stays until other data are drawn in its place, or none are to be', () => {
    const { engine, destroyed } = fakeEngine();
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
    const show = (data: SplatData | null) => {
      cloud.data = data;
      cloud.uploadedTo(engine);
    };
    cloud.uploadedTo(engine);
    cloud.announceDrawn(0, []);
    show(splatDataAt([1, 0, 0]));
    expect(destroyed, 'shaders compile').not.toHaveBeenCalled();
    show(splatDataAt([2, 0, 0]));
    expect(destroyed, 'what was never drawn').toHaveBeenCalledTimes(1);
    cloud.announceDrawn(0, []);
    expect(destroyed, 'what was drawn before').toHaveBeenCalledTimes(2);
    show(splatDataAt([3, 0, 0]));
    show(null);
    expect(destroyed).toHaveBeenCalledTimes(4);
  });

  test('may come back before others were drawn, and stays', () => {
    const { engine, destroyed } = fakeEngine();
    const data = splatDataAt([0, 0, 0]);
    const cloud = new SplatCloudObject(data);
    cloud.uploadedTo(engine);
    cloud.announceDrawn(0, []);
    cloud.data = splatDataAt([1, 0, 0]);
    cloud.data = data;
    cloud.announceDrawn(0, []);
    expect(destroyed).not.toHaveBeenCalled();
  });

  test('gives up the splats on the screen where there is no memory for both', () => {
    const { engine, addPacked, destroyed } = fakeEngine();
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
    const [onError, needsFrame] = [vi.fn(), vi.fn()];
    cloud.onError = onError;
    cloud.uploadedTo(engine);
    cloud.announceDrawn(0, []);
    cloud.data = splatDataAt([1, 0, 0]);
    cloud.addEventListener('needsframe', needsFrame);
    addPacked.mockImplementationOnce(() => {
      throw new GpuLimitError('memory', 2, 1, 'no room for both');
    });
    expect(cloud.uploadedTo(engine)).toBeNull();
    expect(destroyed).toHaveBeenCalledTimes(1);
    expect(needsFrame).toHaveBeenCalledTimes(1);
    expect(cloud.uploadedTo(engine)).not.toBeNull();
    expect(onError).not.toHaveBeenCalled();
  });

  test('that does not fit is reported once, and not tried again', async () => {
    const { engine, addPacked } = fakeEngine();
    const error = new Error('too large');
    addPacked.mockImplementation(() => {
      throw error;
    });
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
    const onError = vi.fn();
    cloud.onError = onError;
    for (let i = 0; i < 3; i++) expect(cloud.uploadedTo(engine)).toBeNull();
    expect(addPacked).toHaveBeenCalledTimes(1);
    await null;
    expect(onError.mock.calls).toEqual([[error]]);
    cloud.data = splatDataAt([1, 0, 0]);
    expect(cloud.uploadedTo(engine)).toBeNull();
    await null;
    expect(onError).toHaveBeenCalledTimes(2);
  });

  /**
   * @fault GPU memory: a cloud in three.js or React finds no memory
   * @consequence `onError` is called once; another use of the splats uploads them again
   */
  test('that finds no memory later is reported once, and not tried again', async () => {
    const { engine, cloud: uploaded, addPacked } = fakeEngine();
    const error = new Error('no memory');
    addPacked.mockReturnValue({ ...uploaded, uploaded: Promise.reject(error) } as unknown as SplatCloud);
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
    const told = new Promise((resolve) => {
      cloud.onError = resolve;
    });
    expect(cloud.uploadedTo(engine)).not.toBeNull();
    expect(await told).toBe(error);
    expect(cloud.uploadedTo(engine)).toBeNull();
    expect(addPacked).toHaveBeenCalledTimes(1);
  });

  test('on a lost device is no error of the cloud', () => {
    const { engine, addPacked } = fakeEngine();
    addPacked.mockImplementation(() => {
      throw new DestroyedError('This engine', 'the device was lost');
    });
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
    cloud.onError = vi.fn();
    expect(cloud.uploadedTo(engine)).toBeNull();
    expect(cloud.onError).not.toHaveBeenCalled();
  });

  /** A cloud whose splats were freed on their engine, and its next load. */
  function readingAgain() {
    const fake = fakeEngine();
    const packed = packedCloudAt([1, 0, 0]);
    const cloud = new SplatCloudObject(new SplatData(packed, 'garden', 'https://a.test/garden.ply'));
    void cloud.data!.prepareRays();
    cloud.uploadedTo(fake.engine);
    cloud.dispose();
    const [onError, needsFrame] = [vi.fn(), vi.fn()];
    cloud.onError = onError;
    cloud.addEventListener('needsframe', needsFrame);
    expect(cloud.uploadedTo(fake.engine)).toBeNull();
    const finish = () => fake.ends[0].resolve(Object.assign(fake.cloud, packed));
    const whenReading = () => expect.poll(() => fake.ends).toHaveLength(1);
    return { ...fake, object: cloud, onError, needsFrame, finish, whenReading };
  }

  test('is not drawn while it is read again, and requests a frame then', async () => {
    const { object, engine, cloud, needsFrame, onError, finish, whenReading } = readingAgain();
    await whenReading();
    expect(object.uploadedTo(engine)).toBeNull();
    expect(needsFrame).not.toHaveBeenCalled();
    finish();
    await expect.poll(() => needsFrame).toHaveBeenCalledTimes(1);
    expect(object.uploadedTo(engine)).toBe(cloud);
    expect(onError).not.toHaveBeenCalled();
  });

  test('that cannot be read again is reported once, and hit by rays still', async () => {
    const { object, engine, load, ends, onError, whenReading } = readingAgain();
    await whenReading();
    const error = new SplatSourceError('garden', 'the server answered 404', 404);
    ends[0].reject(error);
    await expect.poll(() => onError).toHaveBeenCalledExactlyOnceWith(error);
    expect(object.uploadedTo(engine)).toBeNull();
    expect(load).toHaveBeenCalledTimes(1);
    await object.data!.prepareRays();
    const caster = new Raycaster(new Vector3(1, 0, 5), new Vector3(0, 0, -1));
    expect(caster.intersectObject(object)).toHaveLength(1);
  });

  test.each(['disposed', 'replaced'])('that is %s while it is read again is no error', async (how) => {
    const { object, load, onError, needsFrame, whenReading } = readingAgain();
    await whenReading();
    if (how === 'disposed') object.dispose();
    else object.data = null;
    needsFrame.mockClear();
    const { signal } = load.mock.calls[0][1]!;
    expect(signal!.aborted).toBe(true);
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect(onError).not.toHaveBeenCalled();
    expect(needsFrame).not.toHaveBeenCalled();
  });

  test('is copied to a clone, and so are the other properties', () => {
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
    cloud.opacity = 0.5;
    cloud.depthWrite = true;
    cloud.accuracy = 'high';
    cloud.detail = { maxErrorPx: 1 };
    cloud.shDegree = 1;
    cloud.time = 0.25;
    cloud.effects = [brightness(2)];
    cloud.fog = false;
    cloud.reveal = { from: 'camera', durationMs: 100 };
    cloud.position.x = 2;
    const { data, effects, reveal, detail } = cloud;
    expect(cloud.clone()).toMatchObject({ data, opacity: 0.5, depthWrite: true, accuracy: 'high' });
    expect(cloud.clone()).toMatchObject({ shDegree: 1, time: 0.25, effects, fog: false, reveal, detail });
    expect(cloud.clone().position.x).toBe(2);
    expect(cloud.toJSON().object.type).toBe('SplatCloudObject');
  });

  test('counts when objects are measured', () => {
    const cloud = new SplatCloudObject(splatDataAt([-1, 0, 0], [1, 2, 3]));
    cloud.position.x = 10;
    const scene = new Scene();
    scene.add(cloud);
    scene.updateMatrixWorld();
    const { min, max } = new Box3().setFromObject(scene);
    expect([min.toArray(), max.toArray()]).toEqual([
      [9, 0, 0],
      [11, 2, 3],
    ]);
  });
});

describe('the precision on the GPU for an accuracy', () => {
  const [fast, high] = [resolveAccuracy('fast'), resolveAccuracy('high')];

  function uploaded() {
    const { engine, claim } = fakeEngine();
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
    cloud.uploadedTo(engine);
    const needsFrame = vi.fn();
    cloud.addEventListener('needsframe', needsFrame);
    return { cloud, needsFrame, claim, hold: (settings = high) => cloud.hold(engine, settings) };
  }

  const settle = () => new Promise((resolve) => setTimeout(resolve, 0));

  test('is claimed, and a frame is requested when the cloud holds it', async () => {
    const { hold, needsFrame, claim } = uploaded();
    hold(fast);
    await settle();
    expect(needsFrame).not.toHaveBeenCalled();
    hold();
    hold();
    await settle();
    hold();
    expect(claim).toHaveBeenCalledTimes(1);
    expect(needsFrame).toHaveBeenCalledTimes(1);
  });

  test('is reported once if it is unavailable', async () => {
    const { cloud, hold, needsFrame, claim } = uploaded();
    claim.mockRejectedValue(new Error('garden: its source is gone.'));
    cloud.onError = vi.fn();
    for (let frame = 0; frame < 3; frame++) {
      hold();
      await settle();
    }
    expect(claim).toHaveBeenCalledTimes(1);
    expect(cloud.onError).toHaveBeenCalledExactlyOnceWith(expect.any(SplatsPrecisionError));
    expect(cloud.onError).toHaveBeenCalledWith(
      expect.objectContaining({ message: expect.stringMatching(/keep.*garden.*gone/) }),
    );
    expect(needsFrame).not.toHaveBeenCalled();
  });

  test('is logged if it is unavailable and there is no listener', async () => {
    const { hold, claim } = uploaded();
    claim.mockRejectedValue(new Error('gone'));
    const log = vi.spyOn(console, 'warn').mockImplementation(() => {});
    hold();
    await settle();
    expect(log).toHaveBeenCalledExactlyOnceWith(expect.any(SplatsPrecisionError));
    log.mockRestore();
  });

  test('is not reported if it was replaced meanwhile', async () => {
    const { cloud, hold, claim } = uploaded();
    cloud.onError = vi.fn();
    claim.mockRejectedValue(new DOMException('A later request took its place.', 'AbortError'));
    hold();
    await settle();
    claim.mockRejectedValue(new Error('gone'));
    hold(fast);
    cloud.data = null;
    await settle();
    expect(cloud.onError).not.toHaveBeenCalled();
  });
});

test('the first frame is announced once for each data, after three’s frame', async () => {
  const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
  const first = vi.fn();
  cloud.addEventListener('firstframe', first);
  cloud.announceDrawn(0, []);
  expect(first).not.toHaveBeenCalled();
  cloud.announceDrawn(0, []);
  await Promise.resolve();
  expect(first).toHaveBeenCalledTimes(1);
  cloud.data = splatDataAt([1, 0, 0]);
  cloud.announceDrawn(0, []);
  await Promise.resolve();
  expect(first).toHaveBeenCalledTimes(2);
});

/** Waits for the code of effects that come from a scene or change with time, as clouds do. */
async function loadedEffects(cloud: SplatCloudObject, scene = new Scene()): Promise<void> {
  await expect.poll(() => cloud.effectsAt(0, scene, new PerspectiveCamera())).not.toBeNull();
}

describe('previews', () => {
  function previewOn({ engine, cloud }: ReturnType<typeof fakeEngine>): SplatData {
    const { count, origin, chunks, bounds, robustBounds } = packedCloudAt([0, 0, 0]);
    const preview = { ...cloud, count, origin, chunks, bounds, robustBounds, isPreview: true } as SplatCloud;
    const precision = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
    return new SplatData({ engine, cloud: preview, precision });
  }

  test('announce no first frame, and request one each', async () => {
    const fake = fakeEngine();
    const cloud = new SplatCloudObject();
    const [first, needsFrame] = [vi.fn(), vi.fn()];
    cloud.addEventListener('firstframe', first);
    cloud.addEventListener('needsframe', needsFrame);
    for (let i = 1; i <= 2; i++) {
      cloud.data = previewOn(fake);
      expect(needsFrame).toHaveBeenCalledTimes(i);
      cloud.announceDrawn(0, []);
    }
    await Promise.resolve();
    expect(first).not.toHaveBeenCalled();
    cloud.data = splatDataAt([0, 0, 0]);
    cloud.announceDrawn(0, []);
    await Promise.resolve();
    expect(first).toHaveBeenCalledTimes(1);
  });

  test('are revealed once, with what follows them', async () => {
    const fake = fakeEngine();
    const [scene, camera] = [new Scene(), new PerspectiveCamera()];
    const cloud = new SplatCloudObject();
    cloud.reveal = { from: [0, 0, 0], durationMs: 100 };
    await loadedEffects(cloud);
    const radiusAt = (nowMs: number) => {
      const [use] = cloud.effectsAt(nowMs, scene, camera)!;
      return (use?.options as RevealOptions | undefined)?.radius;
    };
    cloud.data = previewOn(fake);
    cloud.announceDrawn(1000, [reveal.effect]);
    cloud.data = previewOn(fake);
    cloud.data = splatDataAt([1, 2, 3]);
    expect(radiusAt(1100)).toBeUndefined();
    cloud.data = splatDataAt([1, 2, 3]);
    expect(radiusAt(1100)).toBe(0);
  });

  test('of a load that has failed are not drawn', () => {
    const fake = fakeEngine();
    const data = previewOn(fake);
    const cloud = new SplatCloudObject(data);
    const preview = cloud.uploadedTo(fake.engine)!;
    expect(preview.isPreview).toBe(true);
    Object.assign(preview, { isDestroyed: true });
    expect(cloud.uploadedTo(fake.engine)).toBeNull();
  });

  test('are not drawn by another renderer, which reports nothing', async () => {
    const cloud = new SplatCloudObject(previewOn(fakeEngine()));
    const onError = vi.fn();
    cloud.onError = onError;
    const other = fakeEngine();
    expect(cloud.uploadedTo(other.engine)).toBeNull();
    cloud.data = null;
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect(onError).not.toHaveBeenCalled();
  });
});

describe('effects', () => {
  const camera = new PerspectiveCamera();

  async function cloudInFog(): Promise<{ cloud: SplatCloudObject; scene: Scene; names: () => string[] }> {
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0], [3, 4, 0]));
    const scene = new Scene();
    scene.fog = new Fog('white', 1, 2);
    scene.add(cloud);
    scene.updateMatrixWorld();
    await loadedEffects(cloud, scene);
    return { cloud, scene, names: () => cloud.effectsAt(0, scene, camera)!.map(({ effect }) => effect.name) };
  }

  test('are the cloud’s own and the scene’s fog, unless the cloud has its own fog or none', async () => {
    const { cloud, scene, names } = await cloudInFog();
    cloud.effects = [tint([1, 0, 0])];
    expect(names()).toEqual(['tint', 'fog']);
    const own = fog({ color: [0, 0, 0], density: 1 });
    cloud.effects = [own];
    expect(cloud.effectsAt(0, scene, camera)).toEqual([own]);
    cloud.effects = [];
    cloud.fog = false;
    expect(names()).toEqual([]);
    cloud.fog = true;
    scene.fog = null;
    expect(names()).toEqual([]);
  });

  test('are cut off by the groups that the cloud is in', async () => {
    const { cloud, scene, names } = await cloudInFog();
    const group = new ClippingGroup();
    group.clippingPlanes = [new Plane(new Vector3(1, 0, 0), 0)];
    scene.fog = null;
    scene.add(group);
    group.add(cloud);
    expect(names()).toEqual(['clipping-groups']);
    group.enabled = false;
    expect(names()).toEqual([]);
  });

  test('reveal requests frames until it is over, and begins again with other data', async () => {
    const { cloud, scene } = await cloudInFog();
    cloud.fog = false;
    cloud.reveal = { from: [0, 0, 0], durationMs: 100, softEdge: 0 };
    const needsFrame = vi.fn();
    cloud.addEventListener('needsframe', needsFrame);
    const radiusAt = (nowMs: number) => {
      const [use] = cloud.effectsAt(nowMs, scene, camera)!;
      return (use?.options as RevealOptions | undefined)?.radius;
    };
    const draw = async (nowMs: number, drawn = [reveal.effect]) => {
      needsFrame.mockClear();
      cloud.announceDrawn(nowMs, drawn);
      expect(needsFrame, 'in the middle of three’s frame').not.toHaveBeenCalled();
      await Promise.resolve();
      return needsFrame.mock.calls.length;
    };
    expect(radiusAt(900)).toBe(0);
    expect(await draw(900, []), 'while shaders for it compile').toBe(0);
    expect(radiusAt(1000)).toBe(0);
    expect(await draw(1000)).toBe(1);
    expect(radiusAt(1050)).toBeCloseTo(5 / 8, 2);
    expect(await draw(1050)).toBe(1);
    expect(radiusAt(1100)).toBeUndefined();
    expect(await draw(1100)).toBe(0);
    cloud.data = splatDataAt([1, 0, 0]);
    expect(radiusAt(1200)).toBe(0);
    expect(await draw(1200)).toBe(1);
    cloud.reveal = null;
    expect(cloud.effectsAt(1200, scene, camera)).toEqual([]);
    expect(await draw(1200)).toBe(0);
  });
});

test('a choice is announced once, however many views share it', () => {
  const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
  const chosen = vi.fn();
  cloud.addEventListener('accuracychosen', ({ choice }) => chosen(choice));
  const choices = [{}, {}] as AccuracyChoice[];
  for (const choice of [choices[0], choices[0], choices[1]]) cloud.announceAccuracy(choice);
  expect(chosen.mock.calls).toEqual([[choices[0]], [choices[1]]]);
});

test('a cloud that was never drawn cannot be measured', async () => {
  const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
  await expect(cloud.chooseAccuracy()).rejects.toThrow(InvalidArgumentError);
});

describe('pickAt', () => {
  const camera = new PerspectiveCamera();
  /** A canvas of 200×100 pixels, shown at half its size, 10 from the left and 20 from the top. */
  const box = { left: 10, top: 20, width: 100, height: 50 };
  const canvas = { width: 200, height: 100, getBoundingClientRect: () => box };
  const renderer = { domElement: canvas } as unknown as WebGPURenderer;
  const event = { clientX: 10.5, clientY: 69.75, offsetX: 7, offsetY: 7 };

  /** A cloud that was drawn. */
  function drawnCloud(): SplatCloudObject {
    const cloud = new SplatCloudObject();
    const scene = new Scene();
    scene.add(cloud);
    scene.updateMatrixWorld();
    vi.spyOn(layersAround(scene)[0].views, 'latest').mockReturnValue({} as never);
    return cloud;
  }

  test('picks the pixel under the pointer, whatever the event is wrapped in', async () => {
    const cloud = drawnCloud();
    const pick = vi.spyOn(cloud, 'pick').mockResolvedValue(null);
    await cloud.pickAt(event, renderer, camera);
    await cloud.pickAt({ nativeEvent: event }, renderer, camera);
    expect(pick.mock.calls).toEqual(Array(2).fill([renderer, camera, 1, 99.5]));
  });

  test('finds nothing on a canvas without a size, nor before the first frame', async () => {
    expect(await new SplatCloudObject().pickAt({} as never, {} as never, camera)).toBeNull();
    const cloud = drawnCloud();
    const pick = vi.spyOn(cloud, 'pick');
    const domElement = { ...canvas, getBoundingClientRect: () => ({ ...box, height: 0 }) };
    expect(await cloud.pickAt(event, { domElement } as never, camera)).toBeNull();
    expect(pick).not.toHaveBeenCalled();
  });

  test.each([{}, { clientX: 1 }, { nativeEvent: null }, { touches: [event] }])(
    'refuses an event without a place: %o',
    async (wrong) => {
      const picking = drawnCloud().pickAt(wrong as never, renderer, camera);
      await expect(picking).rejects.toThrow(InvalidArgumentError);
    },
  );
});

test('a cloud that was never drawn has no splat to pick', async () => {
  const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
  expect(await cloud.pick({} as never, {} as never, 1, 1)).toBeNull();
});
