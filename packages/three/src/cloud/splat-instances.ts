import { type CloudInstances, InvalidArgumentError } from '@websplatter/core';
import { Box3, Color, Matrix4, SRGBColorSpace } from 'three/webgpu';

/**
 * Instances of a SplatCloudObject, as an InstancedMesh draws a mesh: with one upload, and sorted
 * together with all other splats. Each instance has a matrix relative to the object, and optionally
 * a colour, which tints its splats, and an opacity. All other properties are the object's.
 *
 * @example
 * const instances = new SplatInstances(1000);
 * for (let i = 0; i < instances.count; i++)
 *   instances.setMatrixAt(i, new Matrix4().makeTranslation(i % 40, 0, Math.floor(i / 40)));
 * cloud.instances = instances;
 */
export class SplatInstances {
  /** Number of instances to draw, from the first on; at most the `count` of the constructor. */
  count: number;
  /** 16 numbers for each instance, column-major. */
  readonly matrices: Float32Array;
  /** Red, green and blue for each instance, linear as three's are; null before `setColorAt`. */
  colors: Float32Array | null = null;
  /** A number for each instance; null before `setOpacityAt`. */
  opacities: Float32Array | null = null;
  /** Number of times that `needsUpdate` was set. */
  version = 0;

  /**
   * @param count most instances; their matrices are the identity.
   * @throws InvalidArgumentError unless that is a whole number.
   */
  constructor(count: number) {
    if (!(Number.isSafeInteger(count) && count >= 0))
      throw new InvalidArgumentError('count', `count is ${count}; it must be a number of instances.`);
    this.count = count;
    this.matrices = repeated(new Matrix4().elements, count);
  }

  /** Set it after matrices or `count` have changed: the bounds of objects follow in the next frame. */
  set needsUpdate(value: boolean) {
    if (value) this.version++;
  }

  getMatrixAt(index: number, matrix: Matrix4): Matrix4 {
    return matrix.fromArray(this.matrices, 16 * index);
  }

  setMatrixAt(index: number, matrix: Matrix4): void {
    matrix.toArray(this.matrices, 16 * index);
  }

  /** Reads an instance's colour into `color`; white if none was set. */
  getColorAt(index: number, color: Color): Color {
    return this.colors ? color.fromArray(this.colors, 3 * index) : color.setRGB(1, 1, 1);
  }

  /** Tints an instance: multiplies the colours of its splats, both of them sRGB-encoded. */
  setColorAt(index: number, color: Color): void {
    this.colors ??= repeated([1, 1, 1], this.matrices.length / 16);
    color.toArray(this.colors, 3 * index);
  }

  /** Returns an instance's opacity; 1 if none was set. */
  getOpacityAt(index: number): number {
    return this.opacities?.[index] ?? 1;
  }

  /** Sets an instance's opacity, 0…1, which multiplies the object's opacity. */
  setOpacityAt(index: number, opacity: number): void {
    this.opacities ??= repeated([1], this.matrices.length / 16);
    this.opacities[index] = opacity;
  }

  /** `count`, or fewer if there are fewer matrices. */
  get #drawnCount(): number {
    return Math.min(this.count, this.matrices.length / 16);
  }

  /** @internal Returns copies for a frame: if the next frame is refused, they are drawn again. */
  drawn(): CloudInstances {
    const { matrices, colors, opacities } = this;
    const count = this.#drawnCount;
    return {
      modelMatrices: matrices.slice(0, 16 * count),
      ...(colors && { tints: encodedColors(colors, count) }),
      ...(opacities && { opacities: opacities.slice(0, count) }),
    };
  }

  /** @internal Returns the bounds of all instances of a cloud with the bounds `each`. */
  boundsOf(each: Box3): Box3 {
    const [all, box, matrix] = [new Box3(), new Box3(), new Matrix4()];
    const count = this.#drawnCount;
    for (let i = 0; i < count; i++) all.union(box.copy(each).applyMatrix4(this.getMatrixAt(i, matrix)));
    return all;
  }
}

/** sRGB-encodes `count` colours. Runs in each frame: allocates no object per colour. */
function encodedColors(colors: Float32Array, count: number): Float32Array {
  const encoded = new Float32Array(3 * count);
  const [color, rgb] = [new Color(), new Color()];
  for (let i = 0; i < count; i++) {
    color.fromArray(colors, 3 * i).getRGB(rgb, SRGBColorSpace);
    encoded.set([rgb.r, rgb.g, rgb.b], 3 * i);
  }
  return encoded;
}

function repeated(values: ArrayLike<number>, count: number): Float32Array {
  const array = new Float32Array(count * values.length);
  for (let i = 0; i < count; i++) array.set(values, i * values.length);
  return array;
}
