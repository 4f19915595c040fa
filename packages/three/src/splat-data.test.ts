import { type CloudPrecision, packCloud, type SplatEngine } from '@websplatter/core';
import { Box3, Sphere, Vector3 } from 'three/webgpu';
import { describe, expect, test, vi } from 'vitest';
import { SplatData } from './splat-data.ts';
import { fakeEngine } from './testing/fake-engine.ts';
import { splatDataAt, splatSetAt } from './testing/test-clouds.ts';

const FINEST: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f32' };
const MIDDLE: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f16' };
/** As `splatDataAt` packs. */
const PACKED: CloudPrecision = { geometryPrecision: 'packed', shPrecision: 'u8' };

describe('data', () => {
  test('of another precision than the renderer’s is uploaded as it is', () => {
    const { engine, addPacked } = fakeEngine({ accuracy: 'high' });
    const data = splatDataAt([0, 0, 0]);
    data.acquire(engine, {});
    expect(addPacked).toHaveBeenCalledExactlyOnceWith(data.packed, { name: 'test', source: data.packed });
  });

  test('may be read again from its source, but first from memory', () => {
    const { engine, addPacked } = fakeEngine();
    const packed = packCloud(splatSetAt([0, 0, 0]), { geometryPrecision: 'packed' });
    new SplatData(packed, 'garden', 'https://a.test/garden.ply').acquire(engine, {});
    const source = [packed, 'https://a.test/garden.ply'];
    expect(addPacked).toHaveBeenCalledExactlyOnceWith(packed, { name: 'garden', source });
  });

  test.each(['packed', 'f32'] as const)('knows which %s splats are in a volume', (geometryPrecision) => {
    const set = splatSetAt([4, 0, 0], [0, 0, 0], [1, 0, 0], [1, 1, 1]);
    const packed = packCloud({ ...set, origin: [100, 0, 0] }, { geometryPrecision });
    const data = new SplatData(packed);
    expect(data.rowsIn(new Sphere(new Vector3(101, 0, 0), 1.1)).sort()).toEqual([1, 2]);
    expect(data.rowsIn(new Box3(new Vector3(100.5, -1, -1), new Vector3(105, 2, 0.5))).sort()).toEqual([
      0, 2,
    ]);
    expect(data.rowsIn(new Box3())).toEqual([]);
  });

  test('is released by each user once, however often it is told', () => {
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

describe('what the GPU is to hold', () => {
  /** Data on an engine, and what its cloud was asked for. */
  function uploaded(...users: object[]) {
    const { engine, claim, released, releaseOwn, setAccuracy } = fakeEngine();
    const data = splatDataAt([0, 0, 0]);
    for (const user of users) data.acquire(engine, user);
    const asked = () => claim.mock.calls.map(([precision]) => precision);
    const hold = (user: object, precision: CloudPrecision | null) => data.hold(engine, user, precision);
    const release = (user: object) => data.release(engine, user);
    return { hold, asked, released, releaseOwn, setAccuracy, release };
  }

  test('is asked for where it changes, and once for all who need the same', async () => {
    const [first, second] = [{}, {}];
    const { hold, asked } = uploaded(first, second);
    hold(first, PACKED);
    expect(asked()).toEqual([]);
    const answer = hold(first, FINEST);
    expect(hold(first, FINEST)).toBe(answer);
    expect(hold(second, FINEST)).toBe(answer);
    expect(asked()).toEqual([FINEST]);
  });

  test('is what the finest user needs, as long as there is one', () => {
    const [coarse, fine] = [{}, {}];
    const { hold, asked, release } = uploaded(coarse, fine);
    for (let frame = 0; frame < 2; frame++) {
      hold(coarse, PACKED);
      hold(fine, MIDDLE);
    }
    expect(asked()).toEqual([MIDDLE]);
    release(fine);
    hold(coarse, PACKED);
    expect(asked()).toEqual([MIDDLE, PACKED]);
  });

  test('is asked for again where others may have changed it', () => {
    const user = {};
    const { hold, asked, setAccuracy } = uploaded(user);
    hold(user, FINEST);
    setAccuracy('fast');
    hold(user, FINEST);
    expect(asked()).toEqual([FINEST, FINEST]);
    expect(hold(user, null)).toBeNull();
    expect(hold(user, null)).toBeNull();
    hold(user, FINEST);
    expect(asked()).toEqual([FINEST, FINEST, FINEST]);
  });

  test('may be more than can be had', async () => {
    const user = {};
    const { engine, claim } = fakeEngine();
    claim.mockImplementation(vi.fn().mockRejectedValue(new Error('gone')));
    const data = splatDataAt([0, 0, 0]);
    data.acquire(engine, user);
    await expect(data.hold(engine, user, FINEST)).rejects.toThrow('gone');
    await expect(data.hold(engine, user, FINEST)).rejects.toThrow('gone');
    expect(claim).toHaveBeenCalledTimes(1);
  });

  test('is claimed for the users alone, once it is there', async () => {
    const user = {};
    const { hold, releaseOwn } = uploaded(user);
    const answer = hold(user, FINEST);
    expect(releaseOwn).not.toHaveBeenCalled();
    await answer;
    expect(releaseOwn).toHaveBeenCalledTimes(1);
  });

  test('is claimed as long as a user needs anything', () => {
    const [first, second] = [{}, {}];
    const { hold, release, released, asked } = uploaded(first, second);
    hold(first, FINEST);
    hold(second, MIDDLE);
    hold(first, null);
    expect(released).not.toHaveBeenCalled();
    release(second);
    expect(released).toHaveBeenCalledTimes(1);
    // It is another claim then.
    hold(first, FINEST);
    expect(asked()).toEqual([FINEST, FINEST]);
  });
});
