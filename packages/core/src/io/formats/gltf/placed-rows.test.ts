import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { linearPart, type Mat4, multiply4, transform3 } from '../../../data/math/mat4.ts';
import { polarDecomposition } from '../../../data/math/polar-decomposition.ts';
import { readCoefficients } from '../../../data/packing/harmonics.ts';
import { shRestBasis } from '../../../data/splats/spherical-harmonics.ts';
import { type AnyJson, glbBytes, gltfOf, splatAttributes } from '../../../testing/gltf-fixture.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { readSplats } from '../../loading/read-splats.ts';

type ReadSet = Awaited<ReturnType<typeof readSplats>>;

const read = (json: AnyJson, binary: Uint8Array<ArrayBuffer>) =>
  readSplats(glbBytes({ json, binary }), { shPrecision: 'f32' });

/** Σ = R·S²·Rᵀ of a splat, nine values. */
function covarianceOf({ rotations, logScales }: ReadSet, index: number): number[] {
  const [w, x, y, z] = rotations
    .subarray(4 * index, 4 * index + 4)
    .map((value, _, q) => value / Math.hypot(...q));
  const axes = [
    [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  ];
  return Array.from({ length: 9 }, (_, i) =>
    axes.reduce(
      (sum, axis, k) => sum + axis[i % 3] * axis[Math.floor(i / 3)] * Math.exp(2 * logScales[3 * index + k]),
      0,
    ),
  );
}

/** M·Σ·Mᵀ. */
function moved(covariance: readonly number[], m: ArrayLike<number>): number[] {
  return Array.from({ length: 9 }, (_, i) => {
    const [r, c] = [i % 3, Math.floor(i / 3)];
    let sum = 0;
    for (let j = 0; j < 3; j++)
      for (let k = 0; k < 3; k++) sum += m[3 * j + r] * covariance[3 * k + j] * m[3 * k + c];
    return sum;
  });
}

/** Colours above degree 0 that a splat shows along `direction`. */
function colorAlong({ harmonics }: ReadSet, index: number, direction: readonly number[]): number[] {
  const length = Math.hypot(...direction);
  const basis = shRestBasis(
    harmonics.degree,
    direction[0] / length,
    direction[1] / length,
    direction[2] / length,
  );
  const values = new Float64Array(3 * basis.length);
  readCoefficients(harmonics, index, values);
  return [0, 1, 2].map((channel) =>
    basis.reduce((sum, value, k) => sum + value * values[3 * k + channel], 0),
  );
}

/** Compares splats placed by a node with the same unplaced, as the specification says of M. */
function expectPlaced(placed: ReadSet, plain: ReadSet, matrix: Mat4, axes: ArrayLike<number>): void {
  const m = linearPart(matrix);
  const largest = Math.max(...m.map(Math.abs));
  const translation = matrix.subarray(12, 15);
  for (let i = 0; i < plain.count; i++) {
    const position = transform3(m, plain.positions.subarray(3 * i, 3 * i + 3));
    for (let k = 0; k < 3; k++) {
      const error = Math.abs(placed.positions[3 * i + k] + placed.origin[k] - position[k] - translation[k]);
      // Rounded to float32 once, beside the scene's size however far away it is, and to float64.
      const size = 5 * largest + Math.min(40, Math.abs(translation[k]));
      expect(error).toBeLessThan(size * 2 ** -23 + Math.abs(translation[k]) * 2 ** -51);
    }
    const expected = moved(covarianceOf(plain, i), m);
    const found = covarianceOf(placed, i);
    const size = expected[0] + expected[4] + expected[8];
    // Log scales up to 8 are rounded by 2⁻²², doubled by squares; quaternions by 2⁻²⁴, times four.
    for (let k = 0; k < 9; k++) expect(Math.abs(found[k] - expected[k])).toBeLessThan(size * 2 ** -20);
    for (const direction of [
      [1, 2, 3],
      [-3, 1, 0.5],
    ]) {
      const colors = colorAlong(placed, i, transform3(axes, direction));
      // 15 coefficients of up to 0.5, rounded once.
      colorAlong(plain, i, direction).forEach((color, channel) => {
        expect(Math.abs(colors[channel] - color)).toBeLessThan(15 * 2 ** -24);
      });
    }
  }
}

const number = (min: number, max: number) => fc.double({ min, max, noNaN: true });
const unit = fc
  .tuple(number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1))
  .filter((q) => Math.hypot(...q) > 0.1)
  .map((q) => q.map((value) => value / Math.hypot(...q)));
const offset = fc.tuple(number(-10, 10), number(-10, 10), number(-10, 10));

/** Column-major matrix of the unit quaternion x, y, z, w. */
const turnOf = ([x, y, z, w]: readonly number[]) =>
  Float64Array.of(
    ...[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0],
    ...[2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0],
    ...[2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0],
    ...[0, 0, 0, 1],
  );
const scaleOf = ([x, y, z]: readonly number[]) =>
  Float64Array.of(x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0, 0, 0, 0, 1);
const moveOf = ([x, y, z]: readonly number[]) =>
  Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1);

describe('splats go where nodes put them', async () => {
  const { json, binary } = gltfOf(
    splatAttributes(randomSplats({ count: 4, shDegree: 3, logScales: [-8, 0] })),
  );
  const plain = await read(json, binary);
  const runs = { numRuns: 10 };

  test('translation, rotation and scales, one for each axis, mirrors included', async () => {
    const scales = fc.oneof(
      number(0.01, 5).map((scale) => [scale, scale, scale]),
      number(-5, -0.01).map((scale) => [scale, scale, scale]),
      fc.tuple(number(0.01, 5), number(-5, -0.01), number(0.01, 5)),
    );
    await fc.assert(
      fc.asyncProperty(offset, unit, scales, async (translation, rotation, scale) => {
        const nodes = [{ mesh: 0, translation, rotation, scale }];
        const placed = await read({ ...json, nodes }, binary);
        const turn = turnOf(rotation);
        const matrix = multiply4(moveOf(translation), multiply4(turn, scaleOf(scale)));
        expectPlaced(placed, plain, matrix, linearPart(multiply4(turn, scaleOf(scale.map(Math.sign)))));
      }),
      runs,
    );
  });

  test('nested nodes, by matrices of float32', async () => {
    await fc.assert(
      fc.asyncProperty(offset, unit, unit, number(0.1, 5), async (move, outer, inner, size) => {
        const outerMatrix = multiply4(moveOf(move), turnOf(outer)).map(Math.fround);
        const innerMatrix = multiply4(turnOf(inner), scaleOf([size, size, size])).map(Math.fround);
        const nodes = [
          { children: [1], matrix: [...outerMatrix] },
          { mesh: 0, matrix: [...innerMatrix] },
        ];
        const placed = await read({ ...json, nodes }, binary);
        const matrix = multiply4(outerMatrix, innerMatrix);
        expectPlaced(placed, plain, matrix, linearPart(multiply4(turnOf(outer), turnOf(inner))));
      }),
      runs,
    );
  });

  test('nested nodes that shear', async () => {
    const scales = fc.tuple(number(0.2, 3), number(-3, -0.2), number(0.2, 3));
    await fc.assert(
      fc.asyncProperty(offset, unit, scales, scales, async (translation, rotation, outer, inner) => {
        const nodes = [
          { children: [1], translation, scale: outer },
          { mesh: 0, rotation, scale: inner },
        ];
        const placed = await read({ ...json, nodes }, binary);
        const turned = multiply4(turnOf(rotation), scaleOf(inner));
        const matrix = multiply4(moveOf(translation), multiply4(scaleOf(outer), turned));
        expectPlaced(placed, plain, matrix, polarDecomposition(linearPart(matrix))!.rotation);
      }),
      runs,
    );
  });

  test('however far away, they lose nothing beside their own size', async () => {
    const far = fc.tuple(number(-1e7, 1e7), number(-1e7, 1e7), number(-1e7, 1e7));
    await fc.assert(
      fc.asyncProperty(far, far, unit, number(0.1, 5), async (outer, inner, rotation, size) => {
        const nodes = [
          { children: [1], translation: outer },
          { children: [2], rotation, scale: [size, size, size] },
          { mesh: 0, translation: inner.map((value) => value / size) },
        ];
        const placed = await read({ ...json, nodes }, binary);
        const turned = multiply4(turnOf(rotation), scaleOf([size, size, size]));
        const matrix = multiply4(multiply4(moveOf(outer), turned), moveOf(nodes[2].translation!));
        expectPlaced(placed, plain, matrix, linearPart(turnOf(rotation)));
      }),
      runs,
    );
  });

  test('a node brings splats that lie far out back to 0', async () => {
    const set = randomSplats({ count: 40, shDegree: 0 });
    const away = [5e5, -5.3e6, 700];
    set.positions.forEach((value, i) => {
      set.positions[i] = value + away[i % 3];
    });
    const { json, binary } = gltfOf(splatAttributes(set));
    const nodes = [{ mesh: 0, translation: away.map((value) => -value) }];
    const { positions, origin } = await read({ ...json, nodes }, binary);
    expect(origin).toEqual([0, 0, 0]);
    expect([...positions]).toEqual([...set.positions].map((value, i) => value - away[i % 3]));
  });

  test('without rotation, scale and translation nothing changes, to the bit', async () => {
    const nodes = [{ mesh: 0, translation: [0, 0, 0], rotation: [0, 0, 0, 1], scale: [1, 1, 1] }];
    expect(await read({ ...json, nodes }, binary)).toEqual(plain);
    const moves = [{ mesh: 0, translation: [1, 0, 0] }];
    const moved = await read({ ...json, nodes: moves }, binary);
    expect(moved).toMatchObject({
      rotations: plain.rotations,
      logScales: plain.logScales,
      harmonics: plain.harmonics,
    });
  });

  test('a rotation of length zero is none, and one of any length is a rotation', async () => {
    const attributes = splatAttributes(randomSplats({ count: 2, shDegree: 0 }));
    attributes['KHR_gaussian_splatting:ROTATION'].values.set([0, 0, 0, 0, 0, 0, 30, 40]);
    const fixture = gltfOf(attributes);
    const unplaced = await read(fixture.json, fixture.binary);
    expect([...unplaced.rotations]).toEqual([0, 0, 0, 0, 40, 0, 0, 30]);
    unplaced.rotations.set([1]);
    for (const scale of [
      [2, 2, 2],
      [1, 2, 3],
    ]) {
      const nodes = [{ mesh: 0, rotation: [0.6, 0, 0, 0.8], scale }];
      const placed = await read({ ...fixture.json, nodes }, fixture.binary);
      const turn = turnOf([0.6, 0, 0, 0.8]);
      expectPlaced(placed, unplaced, multiply4(turn, scaleOf(scale)), linearPart(turn));
    }
  });
});

describe('a scene of several parts', () => {
  test('is all its splats, in the order of its nodes; other geometry is left out', async () => {
    const three = gltfOf(splatAttributes(randomSplats({ count: 3, shDegree: 2 })));
    const { json } = three;
    const [splats] = json.meshes[0].primitives;
    const plainAttributes = Object.fromEntries(
      Object.entries(splats.attributes).filter(([semantic]) => !/SH_DEGREE_[12]/.test(semantic)),
    );
    const mesh = { attributes: { POSITION: 0 } };
    json.meshes = [
      { primitives: [mesh, splats] },
      { primitives: [{ ...splats, attributes: plainAttributes }] },
      { primitives: [mesh] },
    ];
    json.nodes = [
      { children: [1, 2], translation: [10, 0, 0] },
      { mesh: 1 },
      { mesh: 0, scale: [2, 2, 2] },
      { mesh: 2, scale: [0, 0, 0] },
      { mesh: 1, translation: [0, 5, 0] },
      { mesh: 0 },
    ];
    json.scenes = [{ nodes: [5] }, { nodes: [0, 3, 4] }];
    json.scene = 1;
    const { count, positions, harmonics, fileIndices } = await read(json, three.binary);
    const one = await read({ ...json, scene: 0 }, three.binary);
    expect([count, one.count, harmonics.degree]).toEqual([9, 3, 2]);
    expect([...fileIndices]).toEqual([0, 1, 2, 3, 4, 5, 6, 7, 8]);
    const expected = [
      ...one.positions.map((value, i) => value + (i % 3 === 0 ? 10 : 0)),
      ...one.positions.map((value, i) => 2 * value + (i % 3 === 0 ? 10 : 0)),
      ...one.positions.map((value, i) => value + (i % 3 === 1 ? 5 : 0)),
    ];
    expect([...positions]).toEqual(expected.map(Math.fround));
    const own = one.harmonics.words;
    const none = own.map(() => 0);
    expect(harmonics.words).toEqual(Uint32Array.of(...none, ...own, ...none));
  });

  test('without scenes is all nodes', async () => {
    const { json, binary } = gltfOf(splatAttributes(randomSplats({ count: 1, shDegree: 0 })));
    delete json.scene;
    delete json.scenes;
    json.nodes = [{ mesh: 0 }, { children: [0], translation: [1, 2, 3] }, { mesh: 0 }];
    const { positions } = await read(json, binary);
    const [x, y, z] = positions.subarray(3);
    expect([...positions]).toEqual([x + 1, y + 2, z + 3, x, y, z].map(Math.fround));
  });

  test('a chain of ten thousand nodes does not overflow anything', async () => {
    const { json, binary } = gltfOf(splatAttributes(randomSplats({ count: 1, shDegree: 0 })));
    json.nodes = Array.from({ length: 10_000 }, (_, i) => ({ children: [i + 1] }));
    json.nodes.push({ mesh: 0 });
    expect((await read(json, binary)).count).toBe(1);
  });
});
