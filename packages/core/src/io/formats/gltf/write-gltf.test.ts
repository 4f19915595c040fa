import { expect, test } from 'vitest';
import type { ShDegree, SplatSet } from '../../../data/splats/splat-set.ts';
import { randomSplats, splatsOf } from '../../../testing/random-splats.ts';
import { splatErrors } from '../../../testing/splat-errors.ts';
import { unpackGlb } from '../../containers/glb.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { write } from './write-gltf.ts';

const EPSILON = 2 ** -24;

const again = async (set: SplatSet) =>
  readSplats(await write(set, {}), { name: 'scene.glb', shPrecision: 'f32' });

async function jsonOf(set: SplatSet) {
  const { json, binary } = unpackGlb(await write(set, {}), 'scene.glb');
  return { json: JSON.parse(new TextDecoder().decode(json)), binary: binary! };
}

test.each<ShDegree>([0, 1, 2, 3])(
  'degree %i comes back but for the rounding of activations',
  async (shDegree) => {
    const set = randomSplats({ count: 500, shDegree, logScales: [-20, 6], opacityLogits: [-15, 15] });
    set.rotations.fill(0, 0, 4);
    const found = await again(set);
    expect(found).toMatchObject({ fileFacts: { format: 'gltf', variant: 'glb', writer: 'WebSplatter' } });
    const errors = splatErrors(found, set);
    expect(errors).toMatchObject({ position: 0, colorDc: 0, firstHarmonics: 0, otherHarmonics: 0 });
    // exp is rounded by a part of 2^-24, and so its logarithm, at most 20, which is rounded again.
    expect(errors.logScale).toBeLessThanOrEqual(21 * EPSILON);
    // Opacities below 1 are rounded by half of 2^-24; their logits, at most 15 and times ¼, again.
    expect(errors.opacity).toBeLessThanOrEqual((1 / 2 + 15 / 4) * EPSILON);
    // Four components, each rounded by half of 2^-24, and the file's own four in the test's.
    expect(errors.angle).toBeLessThanOrEqual(4 * EPSILON);
  },
);

test('opacities of 0 and 1, and scales of nothing, come back', async () => {
  const set = splatsOf([{ opacityLogit: Number.NEGATIVE_INFINITY, logScales: [-200, 0, 80] }, {}]);
  const { opacityLogits, logScales } = await again(set);
  expect(opacityLogits).toEqual(set.opacityLogits);
  expect([...logScales.subarray(0, 3)]).toEqual([-20, 0, expect.closeTo(80, 5)]);
});

test('an origin is the node’s translation, and positions keep every bit', async () => {
  const set = randomSplats({ count: 4, origin: [4_500_000.125, 0, -0.1] });
  const { json, binary } = await jsonOf(set);
  expect(json.nodes).toEqual([{ mesh: 0, translation: set.origin }]);
  expect(new Float32Array(binary.buffer.slice(binary.byteOffset), 0, 12)).toEqual(set.positions);
  expect((await jsonOf(randomSplats({ count: 4 }))).json.nodes).toEqual([{ mesh: 0 }]);
});

test('splats come back in the order in which they were drawn', async () => {
  const set = randomSplats({ count: 4 });
  const extensionOf = async (from: SplatSet) =>
    (await jsonOf(from)).json.meshes[0].primitives[0].extensions.KHR_gaussian_splatting;
  expect(await extensionOf(set)).toMatchObject({ extras: { websplatter: { sortBy: 'depth' } } });
  expect((await again(set)).fileFacts).not.toHaveProperty('isSortedByDistance');
  // The only order that the extension defines, and its default.
  const byDistance = { ...set, fileFacts: { format: 'gltf', isSortedByDistance: true } };
  expect(await extensionOf(byDistance)).toEqual({ kernel: 'ellipse', colorSpace: 'srgb_rec709_display' });
  expect((await again(byDistance)).fileFacts).toMatchObject({ isSortedByDistance: true });
});

test('positions have their bounds, as glTF requires', async () => {
  const set = randomSplats({ count: 9 });
  const { json } = await jsonOf(set);
  const column = (axis: number) => [...set.positions].filter((_, i) => i % 3 === axis);
  expect(json.accessors[0]).toMatchObject({
    min: [0, 1, 2].map((axis) => Math.min(...column(axis))),
    max: [0, 1, 2].map((axis) => Math.max(...column(axis))),
  });
});

test('a scale beyond float32 is refused, with the splat', async () => {
  const writing = write(splatsOf([{}, { logScales: [0, 89, 0] }]), {});
  await expect(writing).rejects.toMatchObject({ argument: 'set' });
  await expect(writing).rejects.toThrow(/^Splat 1 has a scale of e\^89/);
});
