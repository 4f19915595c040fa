import { InvalidArgumentError } from '@websplatter/core';
import { Box3, Color, Matrix4, Raycaster, Scene, Vector3 } from 'three/webgpu';
import { describe, expect, test } from 'vitest';
import { splatDataAt } from '../testing/test-clouds.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';
import { SplatInstances } from './splat-instances.ts';

const at = (x: number, y = 0, z = 0) => new Matrix4().makeTranslation(x, y, z);

/** A cloud of one splat at its origin, drawn at each x of `places`. */
function cloudAt(...places: number[]): { cloud: SplatCloudObject; instances: SplatInstances } {
  const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
  const instances = new SplatInstances(places.length);
  for (const [i, x] of places.entries()) instances.setMatrixAt(i, at(x));
  cloud.instances = instances;
  return { cloud, instances };
}

describe('instances', () => {
  test('have what was set, and by default the identity, white, and all of their opacity', () => {
    const instances = new SplatInstances(2);
    const [matrix, color] = [new Matrix4(), new Color()];
    expect(instances.getMatrixAt(1, at(3))).toEqual(new Matrix4());
    expect(instances.getColorAt(1, color)).toEqual(new Color(1, 1, 1));
    expect(instances.getOpacityAt(1)).toBe(1);
    expect(instances.drawn()).toEqual({ modelMatrices: instances.matrices });
    instances.setMatrixAt(1, at(1, 2, 3));
    instances.setColorAt(1, new Color('orange'));
    instances.setOpacityAt(1, 0.25);
    expect(instances.getMatrixAt(1, matrix)).toEqual(at(1, 2, 3));
    expect(instances.getColorAt(0, color)).toEqual(new Color(1, 1, 1));
    expect(instances.getColorAt(1, color).getHexString()).toBe('ffa500');
    expect([0, 1].map((i) => instances.getOpacityAt(i))).toEqual([1, 0.25]);
  });

  test('are drawn as they are now, as many as `count`, with sRGB-encoded tints', () => {
    const instances = new SplatInstances(3);
    instances.count = 2;
    instances.setMatrixAt(1, at(5));
    instances.setColorAt(1, new Color('#336699'));
    instances.setOpacityAt(0, 0.5);
    const { modelMatrices, tints, opacities } = instances.drawn();
    expect(Array.from(modelMatrices)).toEqual([...new Matrix4().elements, ...at(5).elements]);
    expect(Array.from(tints!)).toEqual([
      1,
      1,
      1,
      ...[0.2, 0.4, 0.6].map((value) => expect.closeTo(value, 4)),
    ]);
    expect(opacities).toEqual(Float32Array.of(0.5, 1));
    instances.setMatrixAt(1, at(6));
    expect(modelMatrices[28]).toBe(5);
  });

  test('are as many as there are matrices where `count` says more', () => {
    const instances = new SplatInstances(2);
    instances.setColorAt(0, new Color(1, 1, 1));
    instances.count = Number.POSITIVE_INFINITY;
    const { modelMatrices, tints } = instances.drawn();
    expect([modelMatrices.length, tints!.length]).toEqual([32, 6]);
    const unit = new Box3(new Vector3(0, 0, 0), new Vector3(1, 1, 1));
    expect(instances.boundsOf(unit)).toEqual(unit);
  });

  test('of no whole number are refused', () => {
    for (const count of [-1, 1.5, Number.NaN, undefined as unknown as number])
      expect(() => new SplatInstances(count)).toThrow(InvalidArgumentError);
  });
});

describe('a cloud with instances', () => {
  test('has the bounds of all of them, which follow `needsUpdate`, `count` and other instances', () => {
    const { cloud, instances } = cloudAt(-2, 4);
    const scene = new Scene().add(cloud);
    cloud.position.y = 1;
    const middle = () => {
      scene.updateMatrixWorld();
      return new Box3().setFromObject(cloud).getCenter(new Vector3()).toArray();
    };
    expect(middle()).toEqual([1, 1, 0]);
    instances.setMatrixAt(1, at(8));
    expect(middle()).toEqual([1, 1, 0]);
    instances.needsUpdate = true;
    expect(middle()).toEqual([3, 1, 0]);
    instances.count = 1;
    expect(middle()).toEqual([-2, 1, 0]);
    cloud.data = splatDataAt([0, 0, 5]);
    expect(middle()).toEqual([-2, 1, 5]);
    cloud.instances = null;
    expect(middle()).toEqual([0, 1, 5]);
  });

  test('is met by rays where they are, which tell which one they met', async () => {
    const { cloud, instances } = cloudAt(0, 2, 2, 4);
    instances.setMatrixAt(2, at(2, 0, -3));
    cloud.position.x = 10;
    cloud.updateMatrixWorld();
    await cloud.data!.prepareRays();
    const meet = (x: number) =>
      new Raycaster(new Vector3(x, 0, 5), new Vector3(0, 0, -1)).intersectObject(cloud);
    expect(meet(10)).toMatchObject([{ instanceId: 0, object: cloud, distance: expect.closeTo(5, 1) }]);
    expect(meet(12).map(({ instanceId }) => instanceId)).toEqual([1, 2]);
    expect(meet(11)).toEqual([]);
    instances.setOpacityAt(1, 0.1);
    expect(meet(12).map(({ instanceId }) => instanceId)).toEqual([2]);
    instances.count = 3;
    expect(meet(14)).toEqual([]);
    cloud.instances = null;
    expect(meet(10)[0]).not.toHaveProperty('instanceId');
  });

  test('shares them with its copies', () => {
    const { cloud, instances } = cloudAt(1);
    expect(cloud.clone().instances).toBe(instances);
  });
});
