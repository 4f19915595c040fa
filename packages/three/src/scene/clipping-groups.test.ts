import { InvalidArgumentError } from '@websplatter/core';
import { ClippingGroup, Matrix4, Object3D, Plane, Vector3, Vector4 } from 'three/webgpu';
import { expect, test } from 'vitest';
import { clippingOf } from './clipping-groups.ts';

const PROJECTION = { isOrthographic: false, focalPx: [1, 1] } as const;

/** A group that cuts off splats behind planes with these normals through the origin. */
function groupOf(...normals: readonly (readonly [number, number, number])[]): ClippingGroup {
  const group = new ClippingGroup();
  group.clippingPlanes = normals.map((normal) => new Plane(new Vector3(...normal), 0));
  return group;
}

/** An object in `groups`, the first of which is the outermost. */
function objectIn(...groups: readonly Object3D[]): Object3D {
  const object = new Object3D();
  [...groups, object].reduce((parent, child) => {
    parent.add(child);
    return child;
  });
  return object;
}

/** Whether the effect keeps a splat at `position` from the cloud's `origin`, as its shader does. */
function keeps(
  object: Object3D,
  position: Vector3,
  modelMatrix = new Matrix4(),
  origin: readonly [number, number, number] = [0, 0, 0],
): boolean {
  const [use] = clippingOf(object);
  if (!use) return true;
  const values = use.valuesAt({
    modelMatrix: modelMatrix.elements,
    origin,
    viewMatrix: [],
    projection: PROJECTION,
  })!;
  const point = new Vector4(position.x, position.y, position.z, 1);
  const isBefore = (name: string) => {
    const matrix = values[name] as readonly number[];
    return [0, 4, 8, 12].map((at) => point.dot(new Vector4().fromArray(matrix, at)) >= 0);
  };
  const each = [...isBefore('each0'), ...isBefore('each1')];
  const together = [...isBefore('together0'), ...isBefore('together1')];
  return each.every(Boolean) && together.some(Boolean);
}

const inFront = new Vector3(1, 1, 0);
const beside = new Vector3(1, -1, 0);
const behind = new Vector3(-1, -1, 0);

test('splats are before each plane, or before any plane of an intersection', () => {
  const x: [number, number, number] = [1, 0, 0];
  const y: [number, number, number] = [0, 1, 0];
  const kept = (object: Object3D) => [inFront, beside, behind].map((point) => keeps(object, point));
  expect(kept(objectIn(groupOf(x, y)))).toEqual([true, false, false]);
  const intersection = Object.assign(groupOf(x, y), { clipIntersection: true });
  expect(kept(objectIn(intersection))).toEqual([true, true, false]);
  expect(kept(objectIn(groupOf(y), intersection))).toEqual([true, false, false]);
});

test('groups without planes or switched off cut nothing off, and neither does being beside a group', () => {
  const off = Object.assign(groupOf([1, 0, 0]), { enabled: false });
  expect(clippingOf(objectIn(groupOf(), off, new Object3D()))).toEqual([]);
  const root = new Object3D();
  root.add(groupOf([1, 0, 0]), new Object3D());
  expect(clippingOf(root.children[1])).toEqual([]);
});

test('planes are where the world has them, wherever the cloud and its origin are', () => {
  const group = new ClippingGroup();
  group.clippingPlanes = [new Plane(new Vector3(1, 0, 0), -1e6)];
  const modelMatrix = new Matrix4().makeScale(2, 1, 1).setPosition(1e6, 0, 0);
  const origin = [10, 0, 0] as const;
  const keepsAt = (x: number) => keeps(objectIn(group), new Vector3(x, 0, 0), modelMatrix, origin);
  expect([keepsAt(-9.99), keepsAt(-10.01)]).toEqual([true, false]);
});

test('planes that change are seen by the next frame alone', () => {
  const group = groupOf([1, 0, 0]);
  const [use] = clippingOf(objectIn(group));
  const place = {
    modelMatrix: new Matrix4().elements,
    origin: [0, 0, 0] as const,
    viewMatrix: [],
    projection: PROJECTION,
  };
  const before = JSON.stringify(use.valuesAt(place));
  group.clippingPlanes[0].constant = 5;
  expect(JSON.stringify(use.valuesAt(place))).toBe(before);
});

test('more planes than the effect has room for are an error that names them', () => {
  const planes = Array.from({ length: 5 }, () => [1, 0, 0] as const);
  const cut = () => clippingOf(objectIn(groupOf(...planes), groupOf(...planes)));
  expect(cut).toThrow(InvalidArgumentError);
  expect(cut).toThrow(/10 planes/);
});
