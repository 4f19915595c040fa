import { expect, test } from 'vitest';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { glbBytes, gltfOf, splatAttributes } from '../../../testing/gltf-fixture.ts';
import { plyBytes, splatElement } from '../../../testing/ply-fixture.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { rowsOf } from '../../../testing/rows-of.ts';
import { readSplatPieces, readSplats } from '../../loading/read-splats.ts';

const [NEAR, FAR]: readonly Vec3[] = [
  [0, 0, 0],
  [500_000.25, 5_300_000.5, 700],
];

/** Splats of some centimetres within a metre of one of two places, whose coordinates are doubles. */
function plyOfTwo(count: number, isFar: (row: number) => boolean, type = 'double') {
  const { name, properties } = splatElement(count, 0, (property, row) => {
    const axis = 'xyz'.indexOf(property);
    if (axis >= 0) return (isFar(row) ? FAR : NEAR)[axis] + ((row * [0.618, 0.754, 0.569][axis]) % 1);
    return property.startsWith('scale') ? -4 : property === 'rot_0' ? 1 : 0;
  });
  const typed = properties.map((property) =>
    /^[xyz]$/.test(property.name) ? { ...property, type } : property,
  );
  return plyBytes({ format: 'binary_little_endian', elements: [{ name, count, properties: typed }] });
}

async function notesOf(bytes: Uint8Array<ArrayBuffer>) {
  return (await readSplats(bytes)).fileFacts?.notes;
}

const NOTE = (coarse: string) =>
  expect.stringMatching(
    `^Its parts lie too far apart for float32: ${coarse} splats .* up to 0\\.5, .* 0\\.018\\.`,
  );

test('positions of doubles that no origin suits are told of', async () => {
  expect(await notesOf(plyOfTwo(300, (row) => row % 3 === 0))).toEqual([NOTE('(99|100) of 300')]);
  expect(await notesOf(plyOfTwo(300, (row) => row % 2 === 0))).toEqual([NOTE('1[45]\\d of 300')]);
});

test('strays, scenes in one place and the steps of a file’s own float32 are not', async () => {
  expect(await notesOf(plyOfTwo(300, (row) => row > 9))).toBeUndefined();
  expect(await notesOf(plyOfTwo(300, () => true))).toBeUndefined();
  expect(await notesOf(plyOfTwo(300, (row) => row % 3 === 0, 'float'))).toBeUndefined();
});

test('the last piece counts those of all', async () => {
  const notes: unknown[] = [];
  await readSplatPieces(
    plyOfTwo(40_000, (row) => row % 4 === 0),
    {},
    async ({ fileFacts }) => {
      notes.push(fileFacts?.notes);
    },
  );
  expect(notes.length).toBeGreaterThan(1);
  expect(notes.at(-1)).toEqual([NOTE('9,9\\d\\d of 40,000')]);
});

/**
 * @fault Files: parts of a scene, of a glTF or of scenes that `convert --merge` joins lie too far apart
 *   for float32 about any one origin
 * @consequence a note says how many splats are coarse, and how coarse, in `fileFacts`, `info` and
 *   `convert`
 */
test('nodes of a glTF that lie too far apart are told of, and others are not', async () => {
  const set = randomSplats({ count: 150, shDegree: 0, halfExtent: 0.5, logScales: [-4, -4] });
  const { json, binary } = gltfOf(splatAttributes(set));
  json.scenes = [{ nodes: [0, 1] }];
  const notesAt = async (...places: Vec3[]) => {
    json.nodes = places.map((translation) => ({ mesh: 0, translation }));
    const file = glbBytes({ json, binary });
    const notes = await notesOf(file);
    // Rows that are handed over are told of as well, in pieces of one chunk.
    expect((await rowsOf(file, {}, 1)).notes).toEqual(notes ?? []);
    return notes;
  };
  expect(await notesAt(NEAR, FAR)).toHaveLength(1);
  expect(await notesAt(FAR, [FAR[0] + 5, FAR[1], FAR[2]])).toBeUndefined();
});
