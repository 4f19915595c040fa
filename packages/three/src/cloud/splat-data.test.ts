import {
  type CloudPrecision,
  DestroyedError,
  encodePly,
  GpuLimitError,
  packCloud,
  type SplatCloud,
  type SplatEngine,
  SplatSourceError,
} from '@websplatter/core';
import { collectGarbage } from '@websplatter/node/collect-garbage';
import { Box3, Sphere, Vector3 } from 'three/webgpu';
import { describe, expect, test, vi } from 'vitest';
import { fakeEngine } from '../testing/fake-engine.ts';
import { packedCloudAt, splatDataAt, splatSetAt } from '../testing/test-clouds.ts';
import { rowsIn } from './rows-in.ts';
import { SplatData } from './splat-data.ts';

const FINEST: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f32' };
const MIDDLE: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f16' };
/** Precision of `splatDataAt`. */
const PACKED: CloudPrecision = { geometryPrecision: 'packed', shPrecision: 'u8' };

describe('data', () => {
  test('in another precision than the renderer’s is uploaded unchanged', () => {
    const { engine, addPacked } = fakeEngine({ accuracy: 'high' });
    const packed = packedCloudAt([0, 0, 0]);
    new SplatData(packed, 'test').acquire(engine, {});
    expect(addPacked).toHaveBeenCalledExactlyOnceWith(packed, {
      name: 'test',
      source: packed,
      sourceOptions: {},
    });
  });

  test.each(['packed', 'f32'] as const)('finds the %s splats in a volume', async (geometryPrecision) => {
    const set = splatSetAt([4, 0, 0], [0, 0, 0], [1, 0, 0], [1, 1, 1]);
    const packed = packCloud({ ...set, origin: [100, 0, 0] }, { geometryPrecision });
    const data = new SplatData(packed);
    const rowsIn = async (volume: Box3 | Sphere) => [...(await data.rowsIn(volume))];
    expect(await rowsIn(new Sphere(new Vector3(101, 0, 0), 1.1))).toEqual([1, 2]);
    expect(await rowsIn(new Box3(new Vector3(100.5, -1, -1), new Vector3(105, 2, 0.5)))).toEqual([0, 2]);
    expect(await rowsIn(new Box3())).toEqual([]);
  });

  test('is uploaded anew after an upload that found no memory', async () => {
    const { engine, cloud, addPacked } = fakeEngine();
    const uploaded = Promise.reject(new Error('no memory'));
    addPacked.mockReturnValueOnce({ ...cloud, uploaded, isDestroyed: true } as unknown as SplatCloud);
    const data = splatDataAt([0, 0, 0]);
    const lacking = data.acquire(engine, {});
    await expect.poll(() => data.acquire(engine, {})).not.toBe(lacking);
    expect(data.acquire(engine, {})).toBe(cloud);
  });

  /**
   * @fault Devices and engines: splats and renderers of three.js come and go while engine and device live
   *   on
   * @consequence JavaScript holds no ended object
   */
  test('leave neither themselves nor their cloud in memory, though the engine lives', async () => {
    const uploaded = Promise.resolve();
    const engine = {
      lost: new Promise(() => {}),
      addPacked: () => ({ uploaded, destroy: () => {} }),
    } as unknown as SplatEngine;
    const used = async () => {
      const [data, user] = [splatDataAt([0, 0, 0]), {}];
      const cloud = await data.acquire(engine, user);
      data.release(user);
      return [data, cloud].map((each) => new WeakRef<object>(each));
    };
    const left = await used();
    await collectGarbage();
    expect(left.map((each) => each.deref())).toEqual([undefined, undefined]);
    expect(engine.lost).toBeInstanceOf(Promise);
  });

  test('whose splats are sought on a GPU without memory for that says so', async () => {
    vi.stubGlobal('GPUBufferUsage', {});
    const destroy = vi.fn();
    const device = {
      pushErrorScope: () => {},
      popErrorScope: async () => ({ message: 'none' }),
      createBuffer: () => ({ destroy }),
    };
    const cloud = { name: 'garden', count: 10, device } as unknown as SplatCloud;
    const found = rowsIn(new Box3(), {}, { edits: null, places: [{ cloud, users: new Map() }] }, null, {});
    await expect(found).rejects.toThrow(GpuLimitError);
    expect(destroy).toHaveBeenCalledOnce();
    vi.unstubAllGlobals();
  });
});

const ADDRESS = 'https://a.test/garden.ply';
const file = encodePly(splatSetAt([0, 0, 0], [1, 2, 3])) as BlobPart;
const packedFile = packedCloudAt([0, 0, 0], [1, 2, 3]);

/** The result of a load: the engine's only cloud, with the contents of `packed`. */
function loadedBy(cloud: SplatCloud, packed = packedFile): SplatCloud {
  const { count, origin, chunks, bounds, robustBounds } = packed;
  return Object.assign(cloud, { count, origin, chunks, bounds, robustBounds });
}

describe('data that can be read again', () => {
  test('leaves memory with its first upload, and is read again for another engine', async () => {
    const [first, second] = [fakeEngine(), fakeEngine()];
    const sourceOptions = { maxSplats: 7, request: { maxRetries: 1 } };
    const data = new SplatData(packedFile, 'garden', new URL(ADDRESS), sourceOptions);
    expect(data.acquire(first.engine, {})).toBe(first.cloud);
    expect(first.addPacked).toHaveBeenCalledExactlyOnceWith(packedFile, {
      name: 'garden',
      source: ADDRESS,
      sourceOptions,
    });
    const user = {};
    const reading = data.acquire(second.engine, user);
    expect(data.acquire(second.engine, {})).toBe(reading);
    await expect.poll(() => second.ends).toHaveLength(1);
    const signal = expect.any(AbortSignal);
    expect(second.load).toHaveBeenCalledExactlyOnceWith(ADDRESS, {
      name: 'garden',
      signal,
      precision: PACKED,
      ...sourceOptions,
    });
    second.ends[0].resolve(loadedBy(second.cloud));
    expect(await reading).toBe(second.cloud);
    expect(data.acquire(second.engine, user)).toBe(second.cloud);
    expect(second.addPacked).not.toHaveBeenCalled();
  });

  /** Data that has left memory, and is being read again. */
  async function readingAgain() {
    const [first, fake] = [fakeEngine(), fakeEngine()];
    const data = new SplatData(packedFile, 'garden', ADDRESS);
    data.acquire(first.engine, {});
    const users = [{}, {}];
    const reading = users.map((user) => data.acquire(fake.engine, user))[0];
    await expect.poll(() => fake.ends).toHaveLength(1);
    return { ...fake, data, users, reading };
  }

  test('is no longer read when its last user has released it', async () => {
    const { data, users, reading, load, engine } = await readingAgain();
    const { signal } = load.mock.calls[0][1]!;
    data.release(users[0]);
    expect(signal!.aborted).toBe(false);
    data.release(users[1]);
    await expect(reading).rejects.toMatchObject({ name: 'AbortError' });
    data.acquire(engine, users[0]);
    await expect.poll(() => load).toHaveBeenCalledTimes(2);
  });

  test('leaves nothing where it was released as its reading ended', async () => {
    const { data, users, reading, ends, destroyed, cloud } = await readingAgain();
    ends[0].resolve(loadedBy(cloud));
    for (const user of users) data.release(user);
    await expect(reading).rejects.toMatchObject({ name: 'AbortError' });
    expect(destroyed).toHaveBeenCalledTimes(1);
  });

  test('is read anew after that has failed', async () => {
    const { data, users, reading, load, ends, engine } = await readingAgain();
    ends[0].reject(new SplatSourceError('garden', 'the server answered 404', 404));
    await expect(reading).rejects.toMatchObject({ status: 404 });
    data.acquire(engine, users[0]);
    await expect.poll(() => load).toHaveBeenCalledTimes(2);
  });

  test.each([
    ['fewer', packedCloudAt([1, 2, 3])],
    ['others', packedCloudAt([0, 0, 0], [1, 2, 4])],
  ])('fails where there are %s now', async (_, packed) => {
    const { reading, ends, destroyed, cloud } = await readingAgain();
    ends[0].resolve(loadedBy(cloud, packed));
    await expect(reading).rejects.toThrow(SplatSourceError);
    await expect(reading).rejects.toThrow(/garden.*other splats/);
    expect(destroyed).toHaveBeenCalledTimes(1);
  });

  test('forgets a lost engine', async () => {
    const fake = fakeEngine();
    fake.load.mockRejectedValue(new DestroyedError('This engine', 'the device was lost'));
    const data = new SplatData(packedFile, 'garden', ADDRESS);
    const user = {};
    data.acquire(fake.engine, user);
    fake.lose();
    await Promise.resolve();
    await expect(data.acquire(fake.engine, user)).rejects.toThrow(DestroyedError);
    data.release(user);
    expect(fake.destroyed).not.toHaveBeenCalled();
  });

  test('is searched where it was freed', async () => {
    const { engine } = fakeEngine();
    const data = new SplatData(packedFile, 'garden', new Blob([file]));
    const user = {};
    data.acquire(engine, user);
    data.release(user);
    expect([...(await data.rowsIn(new Sphere(new Vector3(1, 2, 3), 1)))]).toEqual([1]);
  });
});

describe('data without a source', () => {
  test('stays in memory', () => {
    const [first, second] = [fakeEngine(), fakeEngine()];
    const data = new SplatData(packedFile, 'garden');
    for (const { engine } of [first, second]) data.acquire(engine, {});
    for (const { addPacked } of [first, second])
      expect(addPacked).toHaveBeenCalledExactlyOnceWith(packedFile, {
        name: 'garden',
        source: packedFile,
        sourceOptions: {},
      });
  });

  test('and on a GPU only cannot come back', async () => {
    const fake = fakeEngine();
    const loaded = { engine: fake.engine, cloud: loadedBy(fake.cloud), precision: PACKED };
    const data = new SplatData(loaded, 'garden');
    data.dispose();
    await expect(data.acquire(fake.engine, {})).rejects.toThrow(SplatSourceError);
    const freed = new SplatData(loaded, 'garden');
    freed.dispose();
    await expect(freed.rowsIn(new Box3())).rejects.toThrow(DestroyedError);
  });
});

describe('data that an engine has loaded', () => {
  function loaded() {
    const fake = fakeEngine();
    const cloud = loadedBy(fake.cloud);
    const data = new SplatData({ engine: fake.engine, cloud, precision: PACKED }, 'garden', ADDRESS);
    return { ...fake, data };
  }

  test('has its count and bounds, and waits for its first user', () => {
    const { data, engine, cloud, destroyed, addPacked } = loaded();
    expect([data.count, data.bounds.max.toArray()]).toEqual([2, [1, 2, 3]]);
    data.release({});
    expect(destroyed).not.toHaveBeenCalled();
    const user = {};
    expect(data.acquire(engine, user)).toBe(cloud);
    data.release(user);
    expect(destroyed).toHaveBeenCalledTimes(1);
    expect(addPacked).not.toHaveBeenCalled();
  });

  test('is disposed of only where it is not used', () => {
    const unused = loaded();
    unused.data.dispose();
    expect(unused.destroyed).toHaveBeenCalledTimes(1);
    const { data, engine, destroyed } = loaded();
    data.acquire(engine, {});
    data.dispose();
    expect(destroyed).not.toHaveBeenCalled();
  });

  test('stays on the last GPU that a cache has it on', async () => {
    const { data, engine, cloud, destroyed } = loaded();
    data.isCached = true;
    const user = {};
    for (let time = 0; time < 2; time++) {
      expect(data.acquire(engine, user)).toBe(cloud);
      data.release(user);
    }
    expect(destroyed).not.toHaveBeenCalled();
    const other = fakeEngine();
    const reading = data.acquire(other.engine, user);
    expect(destroyed).toHaveBeenCalledTimes(1);
    await expect.poll(() => other.ends).toHaveLength(1);
    other.ends[0].resolve(loadedBy(other.cloud));
    await reading;
    data.release(user);
    expect(other.destroyed).not.toHaveBeenCalled();
    data.dispose();
    expect(other.destroyed).toHaveBeenCalledTimes(1);
  });
});

describe('a preview', () => {
  function preview() {
    const fake = fakeEngine();
    const cloud = Object.assign(loadedBy(fake.cloud), { isPreview: true, name: 'garden' });
    const data = new SplatData({ engine: fake.engine, cloud, precision: PACKED }, 'garden', ADDRESS);
    return { ...fake, data };
  }

  test('waits on other engines until it is released, and is read for none', async () => {
    const { data } = preview();
    const other = fakeEngine();
    const user = {};
    const waiting = data.acquire(other.engine, user);
    const outcome = expect(waiting).rejects.toMatchObject({ name: 'AbortError' });
    // By now it waits.
    await new Promise((resolve) => setTimeout(resolve, 0));
    data.release(user);
    await outcome;
    const late = data.acquire(other.engine, user);
    data.release(user);
    await expect(late).rejects.toMatchObject({ name: 'AbortError' });
    expect(other.load).not.toHaveBeenCalled();
  });

  test('keeps the precision that it has', async () => {
    const { data, engine, claim, releaseOwn } = preview();
    const user = {};
    data.acquire(engine, user);
    await data.hold(engine, user, FINEST);
    expect(claim).not.toHaveBeenCalled();
    expect(releaseOwn).not.toHaveBeenCalled();
  });

  test('has no rows', async () => {
    await expect(preview().data.rowsIn(new Box3())).rejects.toThrow(/garden.*still loading/);
  });
});

describe('the precision on the GPU', () => {
  /** Data on an engine, and the claims on its cloud. */
  function uploaded(...users: object[]) {
    const { engine, claim, released, releaseOwn, setAccuracy } = fakeEngine();
    const data = splatDataAt([0, 0, 0]);
    for (const user of users) data.acquire(engine, user);
    const claims = () => claim.mock.calls.map(([precision]) => precision);
    const hold = (user: object, precision: CloudPrecision | null) => data.hold(engine, user, precision);
    const release = (user: object) => data.release(user);
    return { hold, claims, released, releaseOwn, setAccuracy, release };
  }

  test('is claimed when it changes, and once for all users with the same need', async () => {
    const [first, second] = [{}, {}];
    const { hold, claims } = uploaded(first, second);
    hold(first, PACKED);
    expect(claims()).toEqual([]);
    const met = hold(first, FINEST);
    expect(hold(first, FINEST)).toBe(met);
    expect(hold(second, FINEST)).toBe(met);
    expect(claims()).toEqual([FINEST]);
  });

  test('is the finest that a user needs, until that user releases the cloud', () => {
    const [coarse, fine] = [{}, {}];
    const { hold, claims, release } = uploaded(coarse, fine);
    for (let frame = 0; frame < 2; frame++) {
      hold(coarse, PACKED);
      hold(fine, MIDDLE);
    }
    expect(claims()).toEqual([MIDDLE]);
    release(fine);
    hold(coarse, PACKED);
    expect(claims()).toEqual([MIDDLE, PACKED]);
  });

  test('is claimed again if others may have changed it', () => {
    const user = {};
    const { hold, claims, setAccuracy } = uploaded(user);
    hold(user, FINEST);
    setAccuracy('fast');
    hold(user, FINEST);
    expect(claims()).toEqual([FINEST, FINEST]);
    expect(hold(user, null)).toBeNull();
    expect(hold(user, null)).toBeNull();
    hold(user, FINEST);
    expect(claims()).toEqual([FINEST, FINEST, FINEST]);
  });

  test('is claimed by the users alone, once the cloud holds it', async () => {
    const user = {};
    const { hold, releaseOwn } = uploaded(user);
    const met = hold(user, FINEST);
    expect(releaseOwn).not.toHaveBeenCalled();
    await met;
    expect(releaseOwn).toHaveBeenCalledTimes(1);
  });

  test('is claimed as long as a user has a need', () => {
    const [first, second] = [{}, {}];
    const { hold, release, released, claims } = uploaded(first, second);
    hold(first, FINEST);
    hold(second, MIDDLE);
    hold(first, null);
    expect(released).not.toHaveBeenCalled();
    release(second);
    expect(released).toHaveBeenCalledTimes(1);
    // The next need is another claim.
    hold(first, FINEST);
    expect(claims()).toEqual([FINEST, FINEST]);
  });
});
