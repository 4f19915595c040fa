import { Box3, Matrix4, PerspectiveCamera, Vector3, Vector4 } from 'three/webgpu';
import { describe, expect, test } from 'vitest';
import { type CloudPose, MOST_MOTIONS, motionBetween, type Pose, PoseHistory } from './layer-motion.ts';

const camera = new PerspectiveCamera(60, 1, 0.1, 100);
const ndcToWorld = camera.projectionMatrixInverse;

function cloudAt(x: number, halfSize = 1): CloudPose {
  const bounds = new Box3(new Vector3().setScalar(-halfSize), new Vector3().setScalar(halfSize));
  return { modelMatrix: new Matrix4().makeTranslation(x, 0, -5), bounds };
}

function poseOf(...clouds: readonly (readonly [object, CloudPose])[]): Pose {
  return { clipMatrix: camera.projectionMatrix, clouds: new Map(clouds) };
}

/** Returns the motion of the place (x, 0, −5) along x, in NDC, and where it is in each box. */
function motionAt(previous: Pose, current: Pose, x: number) {
  const { toClip, boxes } = motionBetween(previous, current, ndcToWorld);
  const ndc = new Vector3(x, 0, -5).applyMatrix4(camera.projectionMatrix);
  const at = (matrix: Matrix4) => {
    const { x, w } = new Vector4(ndc.x, ndc.y, ndc.z, 1).applyMatrix4(matrix);
    return x / w;
  };
  return boxes.map((box) => ({ place: at(box.toBox), motion: at(toClip) - at(box.toPreviousClip) }));
}

const [first, second] = [{}, {}];
/** Normalised device coordinates per unit at a depth of 5. */
const scale = 1 / (5 * Math.tan(Math.PI / 6));

describe('motion between two frames', () => {
  test('is exactly none where nothing has moved', () => {
    const pose = poseOf([first, cloudAt(0)], [second, cloudAt(3)]);
    const [{ motion }, ...others] = motionAt(pose, pose, 0.7);
    expect(motion).toBe(0);
    expect(others).toEqual([]);
  });

  test('is that of all clouds where they have moved alike, also beyond their bounds', () => {
    const [{ motion }, ...others] = motionAt(
      poseOf([first, cloudAt(0)], [second, cloudAt(3)]),
      poseOf([first, cloudAt(0.5)], [second, cloudAt(3.5)]),
      9,
    );
    expect(motion).toBeCloseTo(0.5 * scale, 12);
    expect(others).toEqual([]);
  });

  test('is told apart by boxes, of which the smallest is last', () => {
    const [large, small] = motionAt(
      poseOf([first, cloudAt(0, 0.5)], [second, cloudAt(0, 4)]),
      poseOf([first, cloudAt(1, 0.5)], [second, cloudAt(0, 4)]),
      1.25,
    );
    expect(large.motion).toBe(0);
    expect(large.place).toBeCloseTo(1.25 / 4, 12);
    expect(small.motion).toBeCloseTo(scale, 12);
    expect(small.place).toBeCloseTo(0.5, 12);
  });

  test('of clouds that appear, or have no size, is that of the camera', () => {
    const flat = { ...cloudAt(0), modelMatrix: new Matrix4().makeScale(0, 0, 0) };
    const [{ motion }] = motionAt(poseOf(), poseOf([first, cloudAt(0)]), 0);
    expect(motion).toBe(0);
    const boxes = motionAt(poseOf([first, cloudAt(0)]), poseOf([first, flat]), 0);
    expect(boxes[0].motion).toBe(0);
  });

  test('has boxes of some thickness for flat clouds', () => {
    const flat = { ...cloudAt(0), bounds: new Box3(new Vector3(-1, -1, 0), new Vector3(1, 1, 0)) };
    const { boxes } = motionBetween(poseOf(), poseOf([first, flat]), ndcToWorld);
    for (const value of boxes[0].toBox.elements) expect(value).toSatisfy(Number.isFinite);
  });

  test(`keeps the ${MOST_MOTIONS} largest of more clouds`, () => {
    const clouds = Array.from({ length: MOST_MOTIONS + 2 }, (_, i) => [{}, cloudAt(0, 1 + i)] as const);
    const moved = clouds.map(([key, cloud], i) => [key, i === 0 ? cloudAt(1) : cloud] as const);
    const boxes = motionAt(poseOf(...clouds), poseOf(...moved), 3);
    expect(boxes).toHaveLength(MOST_MOTIONS);
    expect(boxes.at(-1)!.place).toBeCloseTo(1, 12);
  });
});

test('poses are told by frames, however often one draws', () => {
  const [one, two, three] = [poseOf(), poseOf(), poseOf()];
  const history = new PoseHistory();
  expect(history.before(4, one)).toBe(one);
  expect(history.before(6, two)).toBe(one);
  expect(history.before(6, two)).toBe(one);
  expect(history.before(7, three)).toBe(two);
});
