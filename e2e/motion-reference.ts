import { cameraFromMatrices } from '@websplatter/core';
import { renderReference } from '@websplatter/core/reference';
import { Matrix4, Vector3, Vector4 } from 'three/webgpu';
import { testScene } from './test-scene.ts';
import type { FramePose } from './three/post-cases.ts';
import type { Pixels } from './three/stage.ts';

/** Result of the page's case `motion`. */
interface Moved {
  readonly before: FramePose;
  readonly after: FramePose;
  readonly velocity: Pixels;
  readonly near: number;
  readonly far: number;
  readonly wallZ: number;
}

/** Errors of motion at pixels of splats and at pixels of the wall behind them, in pixels. */
export interface MotionErrors {
  readonly splats: readonly number[];
  readonly wall: readonly number[];
  /** Largest motion of the reference. */
  readonly largestPx: number;
}

/**
 * Compares motion with a float64 reference: the previous position of the wall, or of the splat with
 * which the pixel's opacity exceeds one half. Pixels left of the middle belong to the first of two
 * clouds.
 */
export function motionErrors({ before, after, velocity, near, far, wallZ }: Moved): MotionErrors {
  const { widthPx, heightPx } = velocity;
  const { data, medianDepths } = renderReference({
    clouds: after.modelMatrices.map((modelMatrix) => ({ set: testScene(), modelMatrix })),
    camera: cameraFromMatrices(after.viewMatrix, after.projectionMatrix, { near, far }),
    widthPx,
    heightPx,
    hostDepths: new Float64Array(widthPx * heightPx).fill(Number.POSITIVE_INFINITY),
  });
  const [clip, clipBefore] = [after, before].map(clipMatrixOf);
  const cameraPlace = new Vector3().setFromMatrixPosition(new Matrix4().fromArray(after.viewMatrix).invert());
  const motions = after.modelMatrices.map((model, i) =>
    new Matrix4().fromArray(before.modelMatrices[i]).multiply(new Matrix4().fromArray(model).invert()),
  );
  const errors = { splats: [] as number[], wall: [] as number[], largestPx: 0 };
  for (let pixel = 0; pixel < widthPx * heightPx; pixel++) {
    const opacity = data[4 * pixel + 3];
    // At an opacity of one half, rounding decides whether the pixel has the splats' motion.
    if (Math.abs(opacity - 0.5) < 0.02) continue;
    const isSplats = opacity > 0.5;
    const x = (2 * ((pixel % widthPx) + 0.5)) / widthPx - 1;
    const y = 1 - (2 * (Math.floor(pixel / widthPx) + 0.5)) / heightPx;
    const direction = new Vector3(x, y, 0.5).applyMatrix4(clip.clone().invert()).sub(cameraPlace);
    const forward = new Vector3().fromArray([2, 6, 10].map((i) => -after.viewMatrix[i]));
    const parts = isSplats
      ? medianDepths![pixel] / opacity / direction.dot(forward)
      : (wallZ - cameraPlace.z) / direction.z;
    const place = direction.multiplyScalar(parts).add(cameraPlace);
    const ndc = ndcOf(clip, place);
    if (isSplats) place.applyMatrix4(motions.length === 1 || place.x < -0.1 ? motions[0] : motions[1]);
    const ndcBefore = ndcOf(clipBefore, place);
    const expected = [ndc.x - ndcBefore.x, ndc.y - ndcBefore.y];
    const errorPx = Math.hypot(
      ...expected.map((value, axis) => ((velocity.data[4 * pixel + axis] - value) * widthPx) / 2),
    );
    errors[isSplats ? 'splats' : 'wall'].push(errorPx);
    errors.largestPx = Math.max(errors.largestPx, (Math.hypot(...expected) * widthPx) / 2);
  }
  return errors;
}

function clipMatrixOf({ viewMatrix, projectionMatrix }: FramePose): Matrix4 {
  return new Matrix4().fromArray(projectionMatrix).multiply(new Matrix4().fromArray(viewMatrix));
}

function ndcOf(clip: Matrix4, { x, y, z }: Vector3): Vector4 {
  const at = new Vector4(x, y, z, 1).applyMatrix4(clip);
  return at.divideScalar(at.w);
}
