import { Box3, Group, OrthographicCamera, PerspectiveCamera, Vector3 } from 'three';
import { expect, it } from 'vitest';
import { type FittedCamera, fitCamera } from './fit-camera.ts';

const box = new Box3(new Vector3(-1, 2, -3), new Vector3(5, 3, 1));

/** Largest of x and y, −1…1, of the box's corners in the image; whether near and far spare all. */
function fillOf(camera: FittedCamera): { readonly fill: number; readonly isWhole: boolean } {
  const corners = Array.from(
    { length: 8 },
    (_, i) =>
      new Vector3(
        i & 1 ? box.max.x : box.min.x,
        i & 2 ? box.max.y : box.min.y,
        i & 4 ? box.max.z : box.min.z,
      ),
  );
  const seen = corners.map((corner) => corner.clone().project(camera));
  const depths = corners.map((corner) => -corner.clone().applyMatrix4(camera.matrixWorldInverse).z);
  return {
    fill: Math.max(...seen.flatMap(({ x, y }) => [Math.abs(x), Math.abs(y)])),
    isWhole: depths.every((depth) => depth > camera.near && depth < camera.far),
  };
}

const cameras: readonly (readonly [string, () => FittedCamera])[] = [
  ['a perspective camera', () => new PerspectiveCamera(40, 1.5, 0.1, 2)],
  ['a wide one of an upright image', () => new PerspectiveCamera(90, 0.5, 50, 100)],
  ['an orthographic camera', () => new OrthographicCamera(-2, 2, 1, -1, 0.1, 1)],
];

it.each(cameras)('%s shows the whole box, and no more than the margin around it', (_, make) => {
  for (const direction of [
    [0, 0, -1],
    [1, -2, 3],
    [0, 1, 0.001],
  ] as const) {
    for (const margin of [1, 1.5]) {
      const camera = make();
      camera.lookAt(direction[0], direction[1], direction[2]);
      const before = camera.quaternion.clone();
      fitCamera(camera, box, margin);
      expect(camera.quaternion.angleTo(before)).toBeCloseTo(0, 6);
      const { fill, isWhole } = fillOf(camera);
      expect(fill).toBeCloseTo(1 / margin, 6);
      expect(isWhole).toBe(true);
    }
  }
});

it('takes cameras in groups that are moved, and leaves a camera alone for an empty box', () => {
  const camera = new PerspectiveCamera(50, 1, 0.1, 100);
  const group = new Group();
  group.position.set(10, 0, 0);
  group.rotation.y = 1;
  group.add(camera);
  fitCamera(camera, box, 1);
  group.updateMatrixWorld();
  expect(fillOf(camera).fill).toBeCloseTo(1, 6);
  const place = camera.position.clone();
  fitCamera(camera, new Box3(), 1);
  expect(camera.position).toEqual(place);
});

it('does not cut off what is behind the box, a sky for instance', () => {
  const camera = new PerspectiveCamera(50, 1, 0.1, 100);
  fitCamera(camera, box, 1, new Box3(new Vector3(-500, -500, -500), new Vector3(500, 500, 500)));
  expect(fillOf(camera).fill).toBeCloseTo(1, 6);
  expect(camera.far).toBeGreaterThan(1700);
  expect(camera.near).toBe(0.1);
});

it('moves before a single point', () => {
  const camera = new PerspectiveCamera(50, 1, 0.1, 100);
  fitCamera(camera, new Box3(new Vector3(1, 2, 3), new Vector3(1, 2, 3)), 1);
  expect(camera.position.toArray()).toEqual([1, 2, 4]);
});
