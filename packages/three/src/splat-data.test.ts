import { type CloudPrecision, packCloud, type SplatEngine } from '@websplatter/core';
import { Box3, Sphere, Vector3 } from 'three/webgpu';
import { describe, expect, test, vi } from 'vitest';
import { SplatData } from './splat-data.ts';
import { fakeEngine } from './testing/fake-engine.ts';
import { splatDataAt, splatSetAt } from './testing/test-clouds.ts';

const FINEST: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f32' };
const MIDDLE: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f16' };
/** Precision of `splatDataAt`. */
const PACKED: CloudPrecision = { geometryPrecision: 'packed', shPrecision: 'u8' };

describe('data', () => {
  test('in another precision than the renderer’s is uploaded unchanged', () => {
    const { engine, addPacked } = fakeEngine({ accuracy: 'high' });
    const data = splatDataAt([0, 0, 0]);
    data.acquire(engine, {});
    expect(addPacked).toHaveBeenCalledExactlyOnceWith(data.packed, { name: 'test', source: data.packed });
  });

  test('can be read again from memory, then from its source', () => {
    const { engine, addPacked } = fakeEngine();
    const packed = packCloud(splatSetAt([0, 0, 0]), { geometryPrecision: 'packed' });
    new SplatData(packed, 'garden', 'https://a.test/garden.ply').acquire(engine, {});
    const source = [packed, 'https://a.test/garden.ply'];
    expect(addPacked).toHaveBeenCalledExactlyOnceWith(packed, { name: 'garden', source });
  });

  test.each(['packed', 'f32'] as const)('finds the %s splats in a volume', (geometryPrecision) => {
    const set = splatSetAt([4, 0, 0], [0, 0, 0], [1, 0, 0], [1, 1, 1]);
    const packed = packCloud({ ...set, origin: [100, 0, 0] }, { geometryPrecision });
    const data = new SplatData(packed);
    expect(data.rowsIn(new Sphere(new Vector3(101, 0, 0), 1.1)).sort()).toEqual([1, 2]);
    expect(data.rowsIn(new Box3(new Vector3(100.5, -1, -1), new Vector3(105, 2, 0.5))).sort()).toEqual([
      0, 2,
    ]);
    expect(data.rowsIn(new Box3())).toEqual([]);
  });

  test('is released by each user once, however often the user calls release', () => {
    const { engine, destroyed } = fakeEngine();
    const data = splatDataAt([0, 0, 0]);
    const [first, second] = [{}, {}];
    for (const user of [first, first, second]) data.acquire(engine, user);
    data.release(engine, first);
    data.release(engine, first);
    expect(destroyed).not.toHaveBeenCalled();
    data.release(engine, second);
    expect(destroyed).toHaveBeenCalledTimes(1);
    expect(() => data.release({} as SplatEngine, first)).not.toThrow();
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
    const release = (user: object) => data.release(engine, user);
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

  test('may be unavailable, and is then claimed only once', async () => {
    const user = {};
    const { engine, claim } = fakeEngine();
    claim.mockImplementation(vi.fn().mockRejectedValue(new Error('gone')));
    const data = splatDataAt([0, 0, 0]);
    data.acquire(engine, user);
    await expect(data.hold(engine, user, FINEST)).rejects.toThrow('gone');
    await expect(data.hold(engine, user, FINEST)).rejects.toThrow('gone');
    expect(claim).toHaveBeenCalledTimes(1);
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
