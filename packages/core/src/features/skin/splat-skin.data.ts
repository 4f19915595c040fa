import { InvalidArgumentError } from '../../data/errors.ts';
import { checkKind, given, wrongArgument } from '../../data/given.ts';
import { isFiniteF32 } from '../../data/math/float-step.ts';
import { identity4, type Mat4, type Vec3 } from '../../data/math/mat4.ts';

/** Joints and weights of each row of a file, or of arrays. */
export interface SkinWeights {
  /** Four joints of each row: whole numbers from 0. */
  readonly indices: ArrayLike<number>;
  /**
   * Four weights of each row, 0 or more and not all 0. They are divided by their sum, and kept in 255
   * steps.
   */
  readonly weights: ArrayLike<number>;
}

/** Joints of a row that move it. */
export const JOINTS_PER_ROW = 4;
/** Most joints: an index has a byte. */
const MOST_JOINTS = 256;

/**
 * Joints that move splats, and the pose that they are in: see `followSkin`. Outlives clouds, engines and
 * devices; 8 bytes per row.
 *
 * @example
 * // The first row follows the first joint; the second row follows both alike.
 * const skin = new SplatSkin({ indices: [0, 0, 0, 0, 0, 1, 0, 0], weights: [1, 0, 0, 0, 1, 1, 0, 0] }, 2);
 * await followSkin(cloud, skin);
 * const [still, raised] = [[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1]];
 * skin.setPose([...still, ...raised]);
 * view.render({ camera, clouds: [{ cloud }], widthPx, heightPx });
 */
export class SplatSkin {
  readonly jointCount: number;
  readonly rowCount: number;
  /** @internal Two words per row: four joints, lowest byte first, and their weights, 255 in all. */
  readonly words: Uint32Array;
  /** @hidden Called before each frame with a cloud that follows: the last moment to set the pose. */
  beforeFrame: (() => void) | null = null;
  #pose: Float64Array;
  #version = 0;

  /**
   * @param jointCount number of joints, 1…256.
   * @throws InvalidArgumentError naming the row, for a joint that there is not, for a weight that is not
   *   a finite number of 0 or more, for a row without weights, and for lists of different lengths.
   */
  constructor(skinWeights: SkinWeights, jointCount: number) {
    const { indices, weights } = given(skinWeights, {}, 'skinWeights');
    if (!(Number.isInteger(jointCount) && jointCount >= 1 && jointCount <= MOST_JOINTS))
      throw wrongArgument('jointCount', jointCount, `a whole number of 1 to ${MOST_JOINTS} joints`);
    checkNumbers('indices', indices);
    checkNumbers('weights', weights);
    if (indices.length !== weights.length || indices.length % JOINTS_PER_ROW !== 0) {
      const message = `indices has ${indices.length} numbers and weights has ${weights.length}; both need four for each row.`;
      throw new InvalidArgumentError('weights', message);
    }
    this.jointCount = jointCount;
    this.rowCount = indices.length / JOINTS_PER_ROW;
    this.words = new Uint32Array(2 * this.rowCount);
    for (let row = 0; row < this.rowCount; row++) this.#pack(row, indices, weights);
    this.#pose = Float64Array.from({ length: 16 * jointCount }, (_, i) => IDENTITY[i % 16]);
  }

  /** @hidden Number of changes of the pose so far. */
  get version(): number {
    return this.#version;
  }

  /** @hidden Sixteen numbers of each joint, which callers do not change. */
  get pose(): Float64Array {
    return this.#pose;
  }

  /**
   * Poses the joints. Clouds that follow show it from their next frame on. The same pose again changes
   * nothing and costs nothing.
   *
   * @param matrices what moves each joint from rest to the pose, in the cloud's space: 16 numbers per
   *   joint, column-major, affine. Identities are the pose at rest.
   * @returns whether the pose has changed.
   * @throws InvalidArgumentError unless there are 16 finite numbers for each joint.
   */
  setPose(matrices: ArrayLike<number>): boolean {
    checkNumbers('matrices', matrices);
    const { length } = this.#pose;
    if (matrices.length !== length) {
      const message = `matrices has ${matrices.length} numbers; ${this.jointCount} joints have ${length}, 16 each.`;
      throw new InvalidArgumentError('matrices', message);
    }
    let isSame = true;
    for (let at = 0; at < length; at++) {
      if (!isFiniteF32(matrices[at])) {
        const joint = Math.floor(at / 16);
        throw wrongArgument(
          `matrices[${at}]`,
          matrices[at],
          `a finite number, of the matrix of joint ${joint}`,
        );
      }
      isSame &&= matrices[at] === this.#pose[at];
    }
    if (isSame) return false;
    this.#pose = Float64Array.from(matrices);
    this.#version++;
    return true;
  }

  /** @hidden Returns where the pose moves a point, in the cloud's space, that is bound as `row` is. */
  moved(row: number, [x, y, z]: Vec3): Vec3 {
    const sum: [number, number, number] = [0, 0, 0];
    for (let k = 0; k < JOINTS_PER_ROW; k++) {
      const weight = ((this.words[2 * row + 1] >>> (8 * k)) & 255) / 255;
      const m = 16 * ((this.words[2 * row] >>> (8 * k)) & 255);
      for (let axis = 0; axis < 3; axis++) {
        const [a, b, c, d] = [0, 4, 8, 12].map((column) => this.#pose[m + column + axis]);
        sum[axis] += weight * (a * x + b * y + c * z + d);
      }
    }
    return sum;
  }

  #pack(row: number, indices: ArrayLike<number>, weights: ArrayLike<number>): void {
    const at = JOINTS_PER_ROW * row;
    let total = 0;
    for (let k = at; k < at + JOINTS_PER_ROW; k++) {
      if (!(Number.isInteger(indices[k]) && indices[k] >= 0 && indices[k] < this.jointCount)) {
        const meaning = `a joint of row ${row}: a whole number below ${this.jointCount}`;
        throw wrongArgument(`indices[${k}]`, indices[k], meaning);
      }
      if (!(isFiniteF32(weights[k]) && weights[k] >= 0))
        throw wrongArgument(
          `weights[${k}]`,
          weights[k],
          `a weight of row ${row}: a finite number, 0 or more`,
        );
      total += weights[k];
    }
    if (!(total > 0)) {
      const message = `Row ${row} has no joint: its four weights are 0. Give one of them a weight.`;
      throw new InvalidArgumentError('weights', message);
    }
    const steps = Array.from({ length: JOINTS_PER_ROW }, (_, k) => (255 * weights[at + k]) / total);
    const whole = steps.map(Math.floor);
    // The largest remainders are rounded up, so that weights sum up to 1.
    const missing = 255 - whole.reduce((sum, step) => sum + step, 0);
    const byRemainder = [0, 1, 2, 3].sort((a, b) => steps[b] - whole[b] - (steps[a] - whole[a]) || a - b);
    for (const k of byRemainder.slice(0, missing)) whole[k]++;
    for (let k = 0; k < JOINTS_PER_ROW; k++) {
      this.words[2 * row] |= indices[at + k] << (8 * k);
      this.words[2 * row + 1] |= whole[k] << (8 * k);
    }
  }
}

const IDENTITY: Mat4 = /* @__PURE__ */ identity4();

/** @throws InvalidArgumentError unless `values` is a list or a typed array. */
function checkNumbers(argument: string, values: ArrayLike<number>): void {
  if (!Array.isArray(values)) checkKind(argument, values, 'a typed array');
}
