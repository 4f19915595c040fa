import { coefficientsPerSplat, type ShDegree, type SplatSet } from '@websplatter/core';

/** Fills the columns of a {@link SplatSet}, a splat at a time, in storage order. */
export class SplatBuilder {
  readonly #count: number;
  readonly #degree: ShDegree;
  readonly #positions: Float32Array;
  readonly #logScales: Float32Array;
  readonly #rotations: Float32Array;
  readonly #opacityLogits: Float32Array;
  readonly #colorDc: Float32Array;
  readonly #harmonics: Float32Array;
  #added = 0;

  constructor(count: number, degree: ShDegree) {
    this.#count = count;
    this.#degree = degree;
    this.#positions = new Float32Array(3 * count);
    this.#logScales = new Float32Array(3 * count);
    this.#rotations = new Float32Array(4 * count);
    this.#opacityLogits = new Float32Array(count);
    this.#colorDc = new Float32Array(3 * count);
    this.#harmonics = new Float32Array(count * coefficientsPerSplat(degree));
  }

  /**
   * @param frame nine numbers: the splat's own axes in the scene, x axis first, orthonormal and
   * right-handed
   * @param scales standard deviations along the axes of `frame`, metres
   * @param opacity in (0, 1)
   * @param coefficients r, g, b per spherical-harmonics basis function, degree 0 first
   */
  add(
    x: number,
    y: number,
    z: number,
    frame: Float64Array,
    scales: Float64Array,
    opacity: number,
    coefficients: Float64Array,
  ): void {
    const index = this.#added++;
    this.#positions[3 * index] = x;
    this.#positions[3 * index + 1] = y;
    this.#positions[3 * index + 2] = z;
    for (let k = 0; k < 3; k++) {
      this.#logScales[3 * index + k] = Math.log(scales[k]);
      this.#colorDc[3 * index + k] = coefficients[k];
    }
    writeQuaternion(frame, this.#rotations, 4 * index);
    this.#opacityLogits[index] = Math.log(opacity / (1 - opacity));
    this.#harmonics.set(coefficients.subarray(3), index * coefficientsPerSplat(this.#degree));
  }

  build(): SplatSet {
    if (this.#added !== this.#count) {
      throw new Error(`The scene's parts made ${this.#added} splats of ${this.#count}.`);
    }
    return {
      count: this.#count,
      origin: [0, 0, 0],
      positions: this.#positions,
      logScales: this.#logScales,
      rotations: this.#rotations,
      opacityLogits: this.#opacityLogits,
      colorDc: this.#colorDc,
      harmonics: { degree: this.#degree, coefficients: this.#harmonics },
      fileIndices: Uint32Array.from({ length: this.#count }, (_, index) => index),
      dropped: {},
    };
  }
}

/** Shepperd's method: divides by the largest component, so that no orientation loses precision. */
function writeQuaternion(frame: Float64Array, out: Float32Array, offset: number): void {
  // The frame holds the rotation's columns: m(row, column) = frame[3·column + row].
  const [m00, m10, m20, m01, m11, m21, m02, m12, m22] = frame;
  const trace = m00 + m11 + m22;
  let w: number;
  let x: number;
  let y: number;
  let z: number;
  if (trace > 0) {
    const s = 2 * Math.sqrt(trace + 1);
    w = s / 4;
    x = (m21 - m12) / s;
    y = (m02 - m20) / s;
    z = (m10 - m01) / s;
  } else if (m00 > m11 && m00 > m22) {
    const s = 2 * Math.sqrt(1 + m00 - m11 - m22);
    w = (m21 - m12) / s;
    x = s / 4;
    y = (m01 + m10) / s;
    z = (m02 + m20) / s;
  } else if (m11 > m22) {
    const s = 2 * Math.sqrt(1 + m11 - m00 - m22);
    w = (m02 - m20) / s;
    x = (m01 + m10) / s;
    y = s / 4;
    z = (m12 + m21) / s;
  } else {
    const s = 2 * Math.sqrt(1 + m22 - m00 - m11);
    w = (m10 - m01) / s;
    x = (m02 + m20) / s;
    y = (m12 + m21) / s;
    z = s / 4;
  }
  out[offset] = w;
  out[offset + 1] = x;
  out[offset + 2] = y;
  out[offset + 3] = z;
}
