import { type Quaternion, rotationMatrixOf } from '../data/editing/quaternion.ts';
import { type Mat3, transform3, type Vec3 } from '../data/math/mat4.ts';
import type { SplatSample } from '../framing/samples.ts';
import { seededRandom } from './seeded-random.ts';

interface MadeSplat {
  readonly position: Vec3;
  readonly opacity: number;
  /** Standard deviations, ascending. */
  readonly sigmas: Vec3;
  readonly normal: Vec3;
}

/**
 * Makes samples of scenes, y up, in units of about a metre. Splats lie at random on surfaces, the
 * same ones each time.
 */
export class MadeScene {
  readonly #splats: MadeSplat[] = [];
  readonly #random = seededRandom(7);

  /** A rectangle from a corner along two edges, covered by flat splats. */
  rectangle(corner: Vec3, edges: readonly [Vec3, Vec3], count: number, sizeM = 0.03): this {
    const [a, b] = edges;
    const normal = crossed(a, b);
    for (let i = 0; i < count; i++) {
      const [u, v] = [this.#random(), this.#random()];
      this.#add(
        [0, 1, 2].map((axis) => corner[axis] + u * a[axis] + v * b[axis]) as unknown as Vec3,
        normal,
        sizeM,
      );
    }
    return this;
  }

  /** All sides of a box. */
  box(min: Vec3, max: Vec3, countOfSide: number, sizeM = 0.03): this {
    const [x, y, z]: Vec3[] = [
      [max[0] - min[0], 0, 0],
      [0, max[1] - min[1], 0],
      [0, 0, max[2] - min[2]],
    ];
    for (const edges of [
      [x, y],
      [y, z],
      [z, x],
    ] as [Vec3, Vec3][]) {
      const away = crossed(...edges).map((part, axis) => part * (max[axis] - min[axis]));
      this.rectangle(min, edges, countOfSide, sizeM);
      this.rectangle(
        min.map((value, axis) => value + away[axis]) as unknown as Vec3,
        edges,
        countOfSide,
        sizeM,
      );
    }
    return this;
  }

  /** A sphere, or its part above the height `lowest`. */
  sphere(
    center: Vec3,
    radiusM: number,
    count: number,
    sizeM = 0.03,
    lowest = Number.NEGATIVE_INFINITY,
  ): this {
    for (let i = 0; i < count; i++) {
      const y = 2 * this.#random() - 1;
      const turn = 2 * Math.PI * this.#random();
      const across = Math.sqrt(1 - y * y);
      const normal: Vec3 = [across * Math.cos(turn), y, across * Math.sin(turn)];
      const position = center.map((value, axis) => value + radiusM * normal[axis]) as unknown as Vec3;
      if (position[1] >= lowest) this.#add(position, normal, sizeM);
    }
    return this;
  }

  /** Round splats all over a box. */
  cloud(min: Vec3, max: Vec3, count: number, sizeM: number, opacity = 0.9): this {
    for (let i = 0; i < count; i++) {
      const position = min.map((low, axis) => low + this.#random() * (max[axis] - low)) as unknown as Vec3;
      this.#splats.push({ position, opacity, sigmas: [sizeM, sizeM, sizeM], normal: [1, 0, 0] });
    }
    return this;
  }

  /** @param turn quaternion w, x, y, z; default: y up becomes y down, as captures have it. */
  sample(turn: Quaternion = Y_DOWN, scale = 1, offset: Vec3 = [0, 0, 0]): SplatSample {
    const matrix = [...rotationMatrixOf(turn)] as Mat3;
    const count = this.#splats.length;
    const positions = new Float64Array(3 * count);
    const [opacities, colors] = [new Float32Array(count), new Float32Array(3 * count)];
    const [sigmas, normals] = [new Float32Array(3 * count), new Float32Array(3 * count)];
    // Lists by flatMap would take a sixth of the time of all tests of cameras.
    for (const [i, splat] of this.#splats.entries()) {
      const position = transform3(matrix, splat.position);
      for (let axis = 0; axis < 3; axis++) positions[3 * i + axis] = scale * position[axis] + offset[axis];
      for (let axis = 0; axis < 3; axis++) sigmas[3 * i + axis] = scale * splat.sigmas[axis];
      normals.set(transform3(matrix, splat.normal), 3 * i);
      opacities[i] = splat.opacity;
    }
    return { count, weight: 1, positions, opacities, sigmas, colors, normals };
  }

  #add(position: Vec3, normal: Vec3, sizeM: number): void {
    this.#splats.push({ position, opacity: 0.95, sigmas: [0.1 * sizeM, sizeM, sizeM], normal });
  }
}

export const Y_UP = [1, 0, 0, 0] as const;
export const Y_DOWN = [0, 1, 0, 0] as const;
/** y up becomes z up. */
export const Z_UP = [Math.SQRT1_2, Math.SQRT1_2, 0, 0] as const;

function crossed(a: Vec3, b: Vec3): Vec3 {
  const [x, y, z] = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}

/** A statue on a plinth on a small square of ground. */
export function statue(): MadeScene {
  return new MadeScene()
    .rectangle(
      [-1.5, 0, -1.5],
      [
        [3, 0, 0],
        [0, 0, 3],
      ],
      4000,
    )
    .box([-0.3, 0, -0.3], [0.3, 0.9, 0.3], 700)
    .box([-0.2, 0.9, -0.12], [0.2, 1.6, 0.12], 900, 0.02)
    .sphere([0, 1.8, 0], 0.2, 1500, 0.015);
}

/** The same in a park: grass, bushes, and a dome of sky. */
export function park(): MadeScene {
  return statue()
    .rectangle(
      [-20, -0.02, -20],
      [
        [40, 0, 0],
        [0, 0, 40],
      ],
      6000,
      0.3,
    )
    .cloud([6, 0, -9], [9, 2, 9], 1500, 0.15)
    .cloud([-9, 0, -9], [-7, 1.5, 9], 1500, 0.15)
    .sphere([0, 0, 0], 80, 1500, 6, -1);
}

/** A room of 5 × 2.6 × 7 m with a table, a cupboard and pictures. */
export function room(): MadeScene {
  return new MadeScene()
    .box([-2.5, 0, -3.5], [2.5, 2.6, 3.5], 3500, 0.05)
    .rectangle(
      [-0.8, 0.75, 0.4],
      [
        [1.6, 0, 0],
        [0, 0, 0.9],
      ],
      1200,
      0.02,
    )
    .box([-0.75, 0, 0.45], [-0.7, 0.75, 0.5], 60, 0.02)
    .box([0.7, 0, 1.2], [0.75, 0.75, 1.25], 60, 0.02)
    .box([-2.4, 0, -3.4], [-1.6, 1.9, -2.2], 700, 0.02)
    .rectangle(
      [2.45, 1, -2],
      [
        [0, 0, 1.5],
        [0, 0.9, 0],
      ],
      800,
      0.015,
    )
    .sphere([0, 0.95, 0.8], 0.15, 900, 0.01);
}
