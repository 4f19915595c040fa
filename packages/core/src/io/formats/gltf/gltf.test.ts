import { once } from 'node:events';
import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { gzipSync } from 'node:zlib';
import { describe, expect, test } from 'vitest';
import { SplatFileError } from '../../../data/errors.ts';
import { type PackedHarmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { coefficientsPerSplat, type SplatSet } from '../../../data/splats/splat-set.ts';
import { expectSamePicture } from '../../../testing/expect-same-picture.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import {
  type AnyJson,
  type FixtureAttribute,
  glbBytes,
  glbOfSpz,
  gltfBytes,
  gltfOf,
  SPZ_EXTENSION,
  splatAttributes,
} from '../../../testing/gltf-fixture.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { expectSameSplats, rowsOf } from '../../../testing/rows-of.ts';
import { unpackGlb } from '../../containers/glb.ts';
import { zipFiles } from '../../containers/write-zip.ts';
import { readSplats } from '../../loading/read-splats.ts';
import type { LoadProgress, SplatSource } from '../../sources/splat-source.ts';
import { detectFormat } from '../detect.ts';
import { distinctSplat, FLAG_ANTIALIASED, spzBytes } from '../spz/spz-fixture.ts';
import { writeSplats } from '../writers.ts';

const SPLATTING = 'KHR_gaussian_splatting';

const read = (source: SplatSource) => readSplats(source, { shPrecision: 'f32', name: 'scene' });

const failure = (source: SplatSource) => fileErrorOf(read(source));

function coefficientsOf({ harmonics, count }: SplatSet<PackedHarmonics>): Float64Array {
  const perSplat = coefficientsPerSplat(harmonics.degree);
  const all = new Float64Array(count * perSplat);
  for (let i = 0; i < count; i++)
    readCoefficients(harmonics, i, all.subarray(i * perSplat, (i + 1) * perSplat));
  return all;
}

function expectNear(found: ArrayLike<number>, expected: ArrayLike<number>, bound: number): void {
  expect(found.length).toBe(expected.length);
  for (let i = 0; i < found.length; i++) {
    const isNear = Math.abs(found[i] - expected[i]) <= bound;
    if (!isNear) expect(found[i], `value ${i}`).toBeCloseTo(expected[i], -Math.log10(2 * bound));
  }
}

/** Unit quaternions x, y, z, w: fractions can hold no others. */
function withUnitRotations(set: SplatSet): SplatSet {
  const rotations = set.rotations.map((value, i) => {
    const q = set.rotations.subarray(i - (i % 4), i - (i % 4) + 4);
    return value / Math.hypot(...q);
  });
  return { ...set, rotations };
}

/** The attribute as integers, `one` of which stand for 1. */
function quantized(
  { values, size }: FixtureAttribute,
  Integers: typeof Int8Array | typeof Uint8Array | typeof Int16Array | typeof Uint16Array,
  one: number,
): FixtureAttribute {
  return { size, isNormalized: true, values: new Integers(values.map((value) => Math.round(value * one))) };
}

describe('how files are told', () => {
  const bytes = (text: string) => new TextEncoder().encode(text);

  test.each([
    'glTF\x02\0\0\0',
    '{"asset":{"generator":"x","version":"2.0"}',
    '\ufeff { "accessors" : []',
    '{"scene":0,"meshes":[{',
  ])('%j is a glTF, whatever its name', (start) => {
    expect(detectFormat(bytes(start), 'scene', ['scene.txt']).name).toBe('gltf');
  });

  test('JSON that begins with anything is one by its name', () => {
    expect(detectFormat(bytes('{"extras":{'), 'scene', ['scene.GLTF']).name).toBe('gltf');
    expect(() => detectFormat(bytes('{"extras":{'), 'scene', ['other.json'])).toThrow(SplatFileError);
    expect(() => detectFormat(bytes('x'), 'scene', ['scene.gltf'])).toThrow(SplatFileError);
  });
});

describe('reads', () => {
  for (const isInterleaved of [false, true]) {
    test.each([0, 1, 2, 3] as const)(`SH degree %i, interleaved: ${isInterleaved}`, async (shDegree) => {
      const set = randomSplats({ count: 5, shDegree });
      const found = await read(glbBytes(gltfOf(splatAttributes(set), isInterleaved)));
      expect(found).toMatchObject({ count: 5, dropped: {}, harmonics: { degree: shDegree } });
      expect(found.isAntialiased).toBeUndefined();
      expect(found.fileFacts).toMatchObject({ format: 'gltf', variant: 'glb' });
      expect([...found.fileIndices]).toEqual([0, 1, 2, 3, 4]);
      expect(found.positions).toEqual(set.positions);
      expect(found.rotations).toEqual(set.rotations);
      expect(found.colorDc).toEqual(set.colorDc);
      expect([...coefficientsOf(found)]).toEqual([...set.harmonics.coefficients]);
      // Scales are rounded to float32 by 2⁻²⁴ of themselves, their logarithms up to 5 by 2⁻²² of 1.
      expectNear(found.logScales, set.logScales, 2 ** -24 + 2 ** -22);
      // Opacities to σ(4) are off by 2⁻²⁵; logits 1/(σ(4)·(1 − σ(4))) = 56.6 times, and 2⁻²².
      expectNear(found.opacityLogits, set.opacityLogits, 56.7 * 2 ** -25 + 2 ** -22);
    });
  }

  /** @fault Files: harmonics above degree 3, in PLY, compressed PLY, SPZ or glTF */
  test('harmonics above degree 3 are left out, with a note', async () => {
    const set = randomSplats({ count: 5, shDegree: 3 });
    const attributes = splatAttributes(set);
    const more = attributes[`${SPLATTING}:SH_DEGREE_3_COEF_0`];
    for (let n = 0; n < 9; n++) attributes[`${SPLATTING}:SH_DEGREE_4_COEF_${n}`] = more;
    const found = await read(glbBytes(gltfOf(attributes)));
    expect([...coefficientsOf(found)]).toEqual([...set.harmonics.coefficients]);
    expect(found.fileFacts?.notes).toEqual(['Its harmonics of degree 4 are left out.']);
  });

  /**
   * @fault Files: a glTF uses words of the extension's drafts, or lacks words that drafts left out
   * @consequence read like the final words; `BT.709-linear` is refused like `lin_rec709_display`
   */
  test('the words that drafts had, and what they left out', async () => {
    const fixture = gltfOf(splatAttributes(randomSplats({ count: 20, shDegree: 1, halfExtent: 0.5 })));
    const own = fixture.json.meshes[0].primitives[0].extensions;
    const expected = await read(glbBytes(fixture));
    for (const words of [
      { kernel: 'ellipse', colorSpace: 'BT.709-sRGB', projection: 'perspective' },
      { kernel: 'ellipse', colorSpace: 'BT.709-srgb', sortingMethod: 'cameraDistance' },
      { colorSpace: 'BT.709' },
      {},
    ]) {
      own[SPLATTING] = words;
      const found = await read(glbBytes(fixture));
      expect(found).toEqual(expected);
      expectSamePicture(found, expected, 100);
    }
  });

  test.each([
    { Signed: Int8Array, Unsigned: Uint8Array, bits: 8 },
    { Signed: Int16Array, Unsigned: Uint16Array, bits: 16 },
  ])('integers of $bits bits that stand for fractions', async ({ Signed, Unsigned, bits }) => {
    const set = withUnitRotations(randomSplats({ count: 50, shDegree: 0, opacityLogits: [-2, 2] }));
    const attributes = splatAttributes(set);
    const most = 2 ** bits - 1;
    const mostSigned = 2 ** (bits - 1) - 1;
    const scales = attributes[`${SPLATTING}:SCALE`];
    const opacities = attributes[`${SPLATTING}:OPACITY`];
    const found = await read(
      glbBytes(
        gltfOf({
          ...attributes,
          POSITION: quantized(attributes.POSITION, Signed, mostSigned),
          [`${SPLATTING}:ROTATION`]: quantized(attributes[`${SPLATTING}:ROTATION`], Signed, mostSigned),
          [`${SPLATTING}:SCALE`]: quantized(scales, Unsigned, most),
          [`${SPLATTING}:OPACITY`]: quantized(opacities, Unsigned, most),
        }),
      ),
    );
    // Half a step, and the rounding of float32.
    expectNear(found.positions, set.positions, 0.5 / mostSigned + 2 ** -24);
    expectNear(found.rotations, set.rotations, 0.5 / mostSigned + 2 ** -24);
    expectNear(found.logScales.map(Math.exp), scales.values, 0.5 / most + 2 ** -20);
    const sigmoids = found.opacityLogits.map((logit) => 1 / (1 + Math.exp(-logit)));
    expectNear(sigmoids, opacities.values, 0.5 / most + 2 ** -22);
  });

  test('integers that stand for themselves, and the lowest one, which is −1 as the next is', async () => {
    const attributes = splatAttributes(randomSplats({ count: 2, shDegree: 0 }));
    const found = await read(
      glbBytes(
        gltfOf({
          ...attributes,
          POSITION: { size: 3, values: Int16Array.of(-300, 0, 7, 1, 2, 3) },
          [`${SPLATTING}:SCALE`]: { size: 3, values: Uint8Array.of(1, 2, 0, 255, 1, 1) },
          [`${SPLATTING}:ROTATION`]: {
            size: 4,
            isNormalized: true,
            values: Int8Array.of(-128, 0, 0, 0, 0, -127, 127, 0),
          },
        }),
      ),
    );
    expect([...found.positions]).toEqual([-300, 0, 7, 1, 2, 3]);
    // A splat may be flat; a logarithm not.
    expectNear(found.logScales, [0, Math.log(2), -20, Math.log(255), 0, 0], 2 ** -21);
    expect([...found.rotations]).toEqual([0, -1, 0, 0, 0, 0, -1, 1]);
  });

  test('opacities of 0 and 1; splats out of range are left out and counted', async () => {
    const attributes = splatAttributes(randomSplats({ count: 6, shDegree: 0 }));
    attributes[`${SPLATTING}:OPACITY`].values.set([0, 1, 1.5, -0.5, Number.NaN, 0.5]);
    attributes[`${SPLATTING}:SCALE`].values.set([-1], 15);
    const found = await read(glbBytes(gltfOf(attributes)));
    expect([...found.opacityLogits]).toEqual([Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY]);
    expect(found.dropped).toEqual({ 'non-finite-opacity': 3, 'non-finite-scale': 1 });
  });

  test('an early end of the chunk, unknown chunks and bytes after the stated end are allowed', async () => {
    const fixture = gltfOf(splatAttributes(randomSplats({ count: 2, shDegree: 0 })));
    const plain = await read(glbBytes(fixture));
    const padded = glbBytes({ ...fixture, binary: Uint8Array.of(...fixture.binary, 0, 0, 0) });
    expect(await read(padded)).toEqual(plain);
    expect(await read(Uint8Array.of(...glbBytes(fixture), 1, 2, 3))).toEqual(plain);
    const unaligned = JSON.stringify(fixture.json).replace('"2.0"', '"2.0" ');
    const text = new TextEncoder().encode(unaligned + ' '.repeat((5 - (unaligned.length % 4)) % 4));
    const bytes = new Uint8Array(28 + text.length + fixture.binary.length);
    bytes.set(glbBytes(fixture).subarray(0, 20));
    bytes.set(text, 20);
    const view = new DataView(bytes.buffer);
    view.setUint32(8, bytes.length, true);
    view.setUint32(12, text.length, true);
    view.setUint32(20 + text.length, fixture.binary.length, true);
    view.setUint32(24 + text.length, 0x004e4942, true);
    bytes.set(fixture.binary, 28 + text.length);
    expect(text.length % 4).not.toBe(0);
    expect(await read(bytes)).toEqual(plain);
  });

  test.each([
    {
      accepts: 'optional properties',
      change: { projection: 'perspective', sortingMethod: 'cameraDistance' },
    },
    { accepts: 'the order of depths, of a draft', change: { sortingMethod: 'zDepth' } },
    { accepts: 'extras of other programs', change: { extras: { sortBy: 'depth', websplatter: 1 } } },
    { accepts: 'extensions that need not be known', change: { extensions: { EXT_more: { x: 1 } } } },
  ])('$accepts', async ({ change }) => {
    const fixture = gltfOf(splatAttributes(randomSplats({ count: 1, shDegree: 0 })));
    Object.assign(fixture.json.meshes[0].primitives[0].extensions[SPLATTING], change);
    fixture.json.extensionsRequired = [SPLATTING, 'KHR_mesh_quantization', 'KHR_materials_unlit'];
    expect((await read(glbBytes(fixture))).count).toBe(1);
  });
});

test.each([
  [['cameraDistance'], true],
  [[undefined], true],
  [['zDepth'], undefined],
  [['zDepth', 'cameraDistance', 'zDepth'], true],
  [['zDepth', undefined], true],
] as const)(
  'primitives with the sorting methods %j: by distance is %s',
  async (methods, isSortedByDistance) => {
    const { json, binary } = gltfOf(splatAttributes(randomSplats({ count: 1, shDegree: 0 })));
    const [primitive] = json.meshes[0].primitives;
    json.meshes[0].primitives = methods.map((sortingMethod) => {
      const extension = { ...primitive.extensions[SPLATTING], sortingMethod };
      return { ...primitive, extensions: { [SPLATTING]: extension } };
    });
    const bytes = glbBytes({ json, binary });
    expect((await read(bytes)).fileFacts?.isSortedByDistance).toBe(isSortedByDistance);
    expect((await rowsOf(new File([bytes], 'a.glb'))).layout.fileFacts?.isSortedByDistance).toBe(
      isSortedByDistance,
    );
  },
);

test('colours for programs that draw points, COLOR_0, may be there and are not needed', async () => {
  const attributes = splatAttributes(randomSplats({ count: 2, shDegree: 1 }));
  const colors = { size: 4, isNormalized: true, values: new Uint8Array(8).fill(200) } as const;
  const plain = await read(glbBytes(gltfOf(attributes)));
  expect(await read(glbBytes(gltfOf({ ...attributes, COLOR_0: colors })))).toEqual(plain);
});

test('facts from the file, and notes on other drawing', async () => {
  const fixture = gltfOf(splatAttributes(randomSplats({ count: 1, shDegree: 0 })));
  const { json } = fixture;
  json.asset.generator = 'a tool 1.2';
  json.meshes[0].primitives.push({ attributes: { POSITION: 0 } });
  const extension = json.meshes[0].primitives[0].extensions[SPLATTING];
  const base64 = Buffer.from(fixture.binary).toString('base64');
  const byDistance = await read(gltfBytes(fixture, `data:;base64,${base64}`));
  expect(byDistance.fileFacts).toEqual({
    format: 'gltf',
    variant: 'gltf',
    writer: 'a tool 1.2',
    isSortedByDistance: true,
    notes: [expect.stringMatching(/^1 other primitive/)],
  });
  extension.sortingMethod = 'zDepth';
  json.meshes[0].primitives.pop();
  delete json.asset.generator;
  expect((await read(glbBytes(fixture))).fileFacts).toEqual({ format: 'gltf', variant: 'glb' });
});

test('instances that are not read are told of, once and only where they are of splats', async () => {
  const { json, binary } = gltfOf(splatAttributes(randomSplats({ count: 1, shDegree: 0 })));
  const extensions = { EXT_mesh_gpu_instancing: { attributes: {} } };
  const notesWith = async (...nodes: object[]) => {
    json.nodes = nodes;
    json.scenes = [{ nodes: nodes.map((_, i) => i) }];
    return (await read(glbBytes({ json, binary }))).fileFacts?.notes;
  };
  json.meshes.push({ primitives: [{ attributes: { POSITION: 0 } }] });
  expect(await notesWith({ mesh: 0, extensions }, { mesh: 0, extensions })).toEqual([
    expect.stringMatching(/^Its instances \(EXT_mesh_gpu_instancing\) are left out/),
  ]);
  expect(await notesWith({ mesh: 0 }, { mesh: 1, extensions })).toEqual(['1 other primitive is left out.']);
});

describe('splats that are an .spz in a buffer', () => {
  const splats = [0, 1, 2].map((row) => distinctSplat(2, 1, row));
  const spz = gzipSync(spzBytes({ version: 2, degree: 1, splats, flags: FLAG_ANTIALIASED }));

  test.each([SPZ_EXTENSION, 'KHR_gaussian_splatting_compression_spz'])(
    '%s gives the splats of the .spz',
    async (name) => {
      const { fileFacts, ...set } = await read(glbOfSpz(spz, 1, name));
      const { fileFacts: _, ...alone } = await read(spz);
      expect(set).toEqual(alone);
      expect(set.isAntialiased).toBe(true);
      expect(fileFacts).toMatchObject({ format: 'gltf', variant: 'glb' });
    },
  );

  test('named as in Cesium’s first tiles, the splats are those of the .spz', async () => {
    const name = 'KHR_spz_gaussian_splats_compression';
    const seen = await writeSplats(randomSplats({ count: 40, halfExtent: 0.5 }), 'spz');
    const { fileFacts, ...set } = await read(glbOfSpz(seen, 1, name, { [name]: { bufferView: 0 } }));
    const { fileFacts: _, ...alone } = await read(seen);
    expect(set).toEqual(alone);
    expect(fileFacts).toEqual({ format: 'gltf', variant: 'glb' });
    expectSamePicture(set, alone, 100);
  });

  test('several primitives give them one after another', async () => {
    const [one, two] = [await read(glbOfSpz(spz)), await read(glbOfSpz(spz, 2))];
    expect(two.count).toBe(2 * one.count);
    expect(two.positions).toEqual(Float32Array.of(...one.positions, ...one.positions));
    expect(two.isAntialiased).toBe(true);
  });

  /**
   * @fault Files: several nodes of a glTF show the same `.spz`
   * @consequence each shows all of its splats
   */
  test('several nodes show the same splats', async () => {
    const one = await read(glbOfSpz(spz));
    const chunks = unpackGlb(glbOfSpz(spz), 'scene');
    const json = JSON.parse(new TextDecoder().decode(chunks.json));
    json.nodes = [{ mesh: 0 }, { mesh: 0 }];
    json.scenes = [{ nodes: [0, 1] }];
    const { positions, colorDc } = await read(glbBytes({ json, binary: Uint8Array.from(spz) }));
    expect(positions).toEqual(Float32Array.of(...one.positions, ...one.positions));
    expect(colorDc).toEqual(Float32Array.of(...one.colorDc, ...one.colorDc));
  });

  test('rows go to the GPU with their harmonics, turned or not', async () => {
    const { json } = unpackGlb(glbOfSpz(spz), 'scene');
    const nodesOf = (...nodes: object[]) => {
      const scene = {
        ...JSON.parse(new TextDecoder().decode(json)),
        nodes,
        scenes: [{ nodes: [...nodes.keys()] }],
      };
      return glbBytes({ json: scene, binary: Uint8Array.from(spz) });
    };
    const turned = { mesh: 0, rotation: [0, 0.6, 0, 0.8] };
    for (const nodes of [[{ mesh: 0 }], [turned], [{ mesh: 0 }, turned]]) {
      const file = nodesOf(...nodes);
      const rows = await rowsOf(file);
      expectSameSplats(rows, await readSplats(file, { shPrecision: 'f32' }));
    }
  });

  test('unpacked bytes are limited, for each primitive and for all', async () => {
    const bytes = 3 * (9 + 1 + 3 + 3 + 3 + 9);
    const readWithin = (file: Uint8Array, maxBytes: number) => readSplats(file, { maxBytes });
    const file = glbOfSpz(spz, 4);
    expect((await readWithin(file, Math.max(file.length, 4 * bytes))).count).toBe(12);
    const zeros = spzBytes({
      version: 2,
      degree: 1,
      splats: Array(500).fill({ ...splats[0], position: [0, 0, 0] }),
    });
    for (const count of [1, 4]) {
      const bomb = glbOfSpz(gzipSync(zeros), count);
      const maxBytes = Math.max(bomb.length, count === 1 ? zeros.length - 1 : 3 * zeros.length);
      await expect(readWithin(bomb, maxBytes)).rejects.toMatchObject({ code: 'too-large' });
    }
  });

  test('cut short at any length, it is refused where the .spz is, which is named', async () => {
    for (let length = 0; length < spz.length; length++) {
      const part = spz.subarray(0, length);
      const isRead = await readSplats(part, { name: 'scene.spz' }).then(
        () => true,
        () => false,
      );
      if (isRead) expect((await read(glbOfSpz(part))).count).toBe(splats.length);
      else expect((await failure(glbOfSpz(part))).message).toContain('meshes[0].primitives[0]');
    }
  });
});

describe('buffers', () => {
  const fixture = gltfOf(splatAttributes(randomSplats({ count: 3, shDegree: 1 })));
  const file = (name: string, bytes: Uint8Array<ArrayBuffer>) => new File([bytes], name);

  test('a file beside the .gltf, also with blanks in its name', async () => {
    const plain = { ...(await read(glbBytes(fixture))), fileFacts: expect.anything() };
    const gltf = file('scene.gltf', gltfBytes(fixture, 'parts/my%20splats.bin'));
    const binary = file('my splats.bin', fixture.binary);
    Object.defineProperty(binary, 'webkitRelativePath', { value: 'parts/my splats.bin' });
    expect(await readSplats({ files: [binary, gltf] }, { shPrecision: 'f32' })).toEqual(plain);
  });

  const NAMES = [
    ...['#', '+', '&', ',', '=', '@', ';', '$', '?', ':', '!', "'", '(', '*', ' ', '%', 'ü', '汉'].map(
      (sign) => [`a${sign}1.bin`, `a${encodeURIComponent(sign)}1.bin`] as const,
    ),
    // As it is not encoded: Blender until 3.4 wrote it so.
    ['10%.bin', '10%.bin'],
    ['a#1.bin', 'a#1.bin'],
    ['a%2B1.bin', 'a%2B1.bin'],
    ['b%20uf/10%.bin', 'b%20uf/10%.bin'],
    ['b uf/10%.bin', 'b%20uf/10%.bin'],
    ['b+uf/c+d.bin', './b%2Buf/c%2Bd.bin'],
    ['a%2Fb.bin', 'a%2Fb.bin'],
  ] as const;

  /**
   * @fault Files: the buffer of a glTF has a name with signs that its URI has to encode, or does not encode
   * @consequence it is found, in lists of files, in archives and by address
   */
  test.each(NAMES)('%s as %s', async (name, uri) => {
    const gltf = gltfBytes(fixture, uri);
    const { positions } = await read(glbBytes(fixture));
    const files = [file('scene.gltf', gltf), file(name, fixture.binary)];
    expect((await readSplats({ files, paths: ['scene.gltf', name] })).positions).toEqual(positions);
    const zip = zipFiles({ 'in/scene.gltf': gltf, [`in/${name}`]: fixture.binary });
    expect((await readSplats(new File([zip], 'scene.zip'))).positions).toEqual(positions);
  });

  test('by address, a server decodes the URI', async () => {
    const served = new Map<string, Uint8Array>();
    const server = createServer((request, response) => {
      const found = served.get(decodeURIComponent(request.url!));
      response.writeHead(found ? 200 : 404).end(found);
    });
    await once(server.listen(0, '127.0.0.1'), 'listening');
    try {
      const base = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
      const { positions } = await read(glbBytes(fixture));
      for (const [name, uri] of [
        ['a+1.bin', 'a%2B1.bin'],
        ['a#1.bin', 'a%231.bin'],
        ['a%2B1.bin', 'a%252B1.bin'],
        ['10%.bin', '10%.bin'],
      ]) {
        served.clear();
        served.set('/scene.gltf', gltfBytes(fixture, uri)).set(`/${name}`, fixture.binary);
        expect((await readSplats(`${base}/scene.gltf`)).positions).toEqual(positions);
      }
    } finally {
      server.closeAllConnections();
      server.close();
    }
  });

  test('the file of the plain name comes before the one of the decoded name', async () => {
    const other = gltfOf(splatAttributes(randomSplats({ count: 3, shDegree: 1, seed: 9 })));
    const files = [
      file('scene.gltf', gltfBytes(fixture, 'a%20b.bin')),
      file('a b.bin', other.binary),
      file('a%20b.bin', fixture.binary),
    ];
    expect((await readSplats({ files })).positions).toEqual((await read(glbBytes(fixture))).positions);
  });

  test('an encoded slash leads to no folder', async () => {
    const files = [file('scene.gltf', gltfBytes(fixture, 'a%2Fb.bin')), file('b.bin', fixture.binary)];
    const error = await failure({ files, paths: ['scene.gltf', 'a/b.bin'] });
    expect(error).toMatchObject({ code: 'missing-part' });
    expect(error.message).toMatch(/needs a%2Fb\.bin/);
  });

  test('a data: URI', async () => {
    const plain = { ...(await read(glbBytes(fixture))), fileFacts: expect.anything() };
    const base64 = Buffer.from(fixture.binary).toString('base64');
    for (const type of ['application/octet-stream', 'application/gltf-buffer', ''])
      expect(await read(gltfBytes(fixture, `data:${type};base64,${base64}`))).toEqual(plain);
  });

  test('progress counts the bytes of both files', async () => {
    const gltf = file('scene.gltf', gltfBytes(fixture, 'scene.bin'));
    const reports: LoadProgress[] = [];
    const onProgress = (progress: LoadProgress) => void reports.push(progress);
    await readSplats({ files: [gltf, file('scene.bin', fixture.binary)] }, { onProgress });
    const bytes = gltf.size + fixture.binary.length;
    expect(reports.at(-1)).toMatchObject({ loadedBytes: bytes, totalBytes: bytes });
  });

  test('one file for several buffers is read once, and buffers that splats do not need not at all', async () => {
    const { json, binary } = gltfOf(splatAttributes(randomSplats({ count: 3, shDegree: 0 })));
    json.buffers = [{ byteLength: 1e9, uri: 'textures.bin' }];
    json.bufferViews.forEach((view: AnyJson, i: number) => {
      json.buffers.push({ byteLength: binary.length, uri: 'splats.bin' });
      view.buffer = i + 1;
    });
    const gltf = file('scene.gltf', new TextEncoder().encode(JSON.stringify(json)));
    const maxBytes = gltf.size + binary.length;
    const set = await readSplats({ files: [gltf, file('splats.bin', binary)] }, { maxBytes });
    expect(set.count).toBe(3);
  });

  test.each([
    { source: () => gltfBytes(fixture, 'scene.bin'), code: 'missing-part', says: /needs scene\.bin/ },
    {
      source: () => ({ files: [file('scene.gltf', gltfBytes(fixture, '../scene.bin'))] }),
      code: 'missing-part',
      says: /scene\.bin, which is not among/,
    },
    {
      source: () => ({
        files: [
          file('scene.gltf', gltfBytes(fixture, 'scene.bin')),
          file('scene.bin', fixture.binary.subarray(1)),
        ],
      }),
      code: 'truncated',
      says: /buffers\[0\] must have 276 bytes and has 275/,
    },
    { source: () => gltfBytes(fixture, '%ff'), code: 'missing-part', says: /it needs %ff, another file/ },
    {
      source: () => ({
        files: [file('scene.gltf', gltfBytes(fixture, 'scan%2B1.bin')), file('scan+2.bin', fixture.binary)],
      }),
      code: 'missing-part',
      says: /it needs scan\+1\.bin, which is not among/,
    },
    { source: () => gltfBytes(fixture, 'a'.repeat(2000)), code: 'bad-header', says: /no valid one/ },
    { source: () => gltfBytes(fixture, 'data:,x'), code: 'damaged', says: /is no base64/ },
    {
      source: () => gltfBytes(fixture, 'data:;base64,AAA'),
      code: 'damaged',
      says: /must have 276 bytes and has 2/,
    },
    {
      source: () => new TextEncoder().encode(JSON.stringify(fixture.json)),
      code: 'damaged',
      says: /no address/,
    },
  ])('$code: $says', async ({ source, code, says }) => {
    const error = await failure(source());
    expect(error.code).toBe(code);
    expect(error.message).toMatch(says);
  });

  test('bytes of other files are limited', async () => {
    const gltf = file('scene.gltf', gltfBytes(fixture, 'scene.bin'));
    const reading = readSplats({ files: [gltf, file('scene.bin', fixture.binary)] }, { maxBytes: gltf.size });
    if (gltf.size >= fixture.binary.length) return expect((await reading).count).toBe(3);
    await expect(reading).rejects.toMatchObject({ code: 'too-large' });
  });
});

/**
 * @fault Files: a glTF that shows splats in tens of thousands of places
 * @consequence `SplatFileError` `too-large`, before any is read
 */
describe('files that are refused', () => {
  const primitiveOf = (json: AnyJson) => json.meshes[0].primitives[0];
  const extensionOf = (json: AnyJson) => primitiveOf(json).extensions[SPLATTING];
  const cases: readonly [code: string, says: RegExp, change: (json: AnyJson) => void][] = [
    ['bad-header', /asset\.version is undefined/, (json) => delete json.asset],
    ['unknown-format', /it is glTF 1\.0/, (json) => (json.asset.version = '1.0')],
    [
      'unknown-format',
      /without \["KHR_future"\]/,
      (json) => (json.extensionsRequired = [SPLATTING, 'KHR_future']),
    ],
    [
      'unknown-format',
      /without \[\{toString: 1\}\]/,
      (json) => (json.extensionsRequired = [{ toString: 1 }]),
    ],
    ['bad-header', /extensionsRequired is x, no list/, (json) => (json.extensionsRequired = 'x')],
    ['not-splats', /has 1 primitives, all of them without/, (json) => delete primitiveOf(json).extensions],
    ['not-splats', /nothing in its scene has/, (json) => (json.scenes[0].nodes = [])],
    ['damaged', /the file refers to scenes\[3\]/, (json) => (json.scene = 3)],
    ['damaged', /scenes\[0\] refers to nodes\[7\]/, (json) => json.scenes[0].nodes.push(7)],
    ['damaged', /refers to meshes\[length\]/, (json) => (json.nodes[0].mesh = 'length')],
    ['damaged', /nodes\[0\] hangs below two nodes/, (json) => json.scenes[0].nodes.push(0)],
    ['damaged', /nodes\[0\] hangs below two nodes/, (json) => (json.nodes[0].children = [0])],
    [
      'bad-header',
      /matrix of nodes\[0\] is \[1, 2\]; it must be 16/,
      (json) => (json.nodes[0].matrix = [1, 2]),
    ],
    ['bad-header', /last row/, (json) => (json.nodes[0].matrix = new Array(16).fill(1))],
    ['bad-header', /no unit quaternion/, (json) => (json.nodes[0].rotation = [0, 0, 0, 0])],
    ['bad-property', /an axis has no length/, (json) => (json.nodes[0].scale = [1, 0, 1])],
    [
      'bad-property',
      /axes lie in a plane/,
      (json) => (json.nodes[0].matrix = [1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1]),
    ],
    ['bad-property', /mode of meshes\[0\]\.primitives\[0\] is 4/, (json) => (primitiveOf(json).mode = 4)],
    ['bad-property', /kernel of .* is null/, (json) => (extensionOf(json).kernel = null)],
    ['bad-property', /kernel of .* is box/, (json) => (extensionOf(json).kernel = 'box')],
    [
      'bad-property',
      /colorSpace .* is lin_rec709_display; only srgb_rec709_display or BT\.709-sRGB or .* can/,
      (json) => (extensionOf(json).colorSpace = 'lin_rec709_display'),
    ],
    [
      'bad-property',
      /colorSpace .* is BT\.709-linear; only srgb_rec709_display/,
      (json) => (extensionOf(json).colorSpace = 'BT.709-linear'),
    ],
    ['bad-property', /is Display-P3/, (json) => (extensionOf(json).colorSpace = 'Display-P3')],
    ['bad-property', /projection/, (json) => (extensionOf(json).projection = 'fisheye')],
    ['bad-property', /sortingMethod/, (json) => (extensionOf(json).sortingMethod = 'none')],
    [
      'bad-header',
      /scene, meshes\[0\]\.primitives\[0\].* is no SPZ/,
      (json) => (extensionOf(json).extensions = { [SPZ_EXTENSION]: { bufferView: 0 } }),
    ],
    [
      'damaged',
      /refers to bufferViews\[undefined\]/,
      (json) => (extensionOf(json).extensions = { [SPZ_EXTENSION]: {} }),
    ],
    ['not-splats', /lacks POSITION,/, (json) => delete primitiveOf(json).attributes.POSITION],
    [
      'not-splats',
      /lacks SCALE, ROTATION, OPACITY, SH_DEGREE_0_COEF_0,/,
      (json) => (primitiveOf(json).attributes = { POSITION: 0 }),
    ],
    [
      'bad-property',
      /lacks KHR_gaussian_splatting:SH_DEGREE_1_COEF_2/,
      (json) => delete primitiveOf(json).attributes[`${SPLATTING}:SH_DEGREE_1_COEF_2`],
    ],
    [
      'bad-property',
      /has 17 coefficients/,
      (json) => {
        for (let n = 0; n < 13; n++) primitiveOf(json).attributes[`${SPLATTING}:SH_DEGREE_3_COEF_${n}`] = 0;
      },
    ],
    ['damaged', /refers to accessors\[99\]/, (json) => (primitiveOf(json).attributes.POSITION = 99)],
    [
      'bad-property',
      /VEC3 of unsigned; .*ROTATION must be VEC4/,
      (json) => {
        json.accessors[1].componentType = 5121;
        json.accessors[1].type = 'VEC3';
      },
    ],
    ['bad-property', /component type 5125/, (json) => (json.accessors[0].componentType = 5125)],
    ['bad-property', /is sparse/, (json) => (json.accessors[2].sparse = { count: 1 })],
    ['damaged', /has no bufferView/, (json) => delete json.accessors[2].bufferView],
    ['damaged', /has 4 rows; POSITION of the same splats has 3/, (json) => (json.accessors[2].count = 4)],
    [
      'damaged',
      /needs 48 bytes of a bufferView that has 36/,
      (json) => {
        for (const accessor of json.accessors) accessor.count = 4;
      },
    ],
    ['damaged', /of a bufferView that has 36/, (json) => (json.accessors[0].count = 2 ** 53 - 1)],
    ['bad-header', /count of accessors\[0\] is -1/, (json) => (json.accessors[0].count = -1)],
    [
      'empty',
      /0 splats/,
      (json) => {
        for (const accessor of json.accessors) accessor.count = 0;
      },
    ],
    ['damaged', /begins at a byte that is no multiple of 4/, (json) => (json.accessors[3].byteOffset = 2)],
    ['damaged', /rows 8 bytes apart/, (json) => (json.bufferViews[0].byteStride = 8)],
    ['damaged', /rows 14 bytes apart/, (json) => (json.bufferViews[0].byteStride = 14)],
    ['damaged', /bytes 0 to 1000 of a buffer of 276/, (json) => (json.bufferViews[0].byteLength = 1000)],
    ['bad-header', /byteLength of bufferViews\[0\]/, (json) => (json.bufferViews[0].byteLength = 1e300)],
    ['damaged', /must have 9000 bytes and has 276/, (json) => (json.buffers[0].byteLength = 9000)],
    ['damaged', /refers to buffers\[null\]/, (json) => (json.bufferViews[0].buffer = null)],
    [
      'too-large',
      /nodes show splats in 32768 places; at most 16384 are read/,
      (json) => {
        json.nodes = [{ children: Array.from({ length: 2 ** 15 }, (_, i) => i + 1) }];
        for (let i = 0; i < 2 ** 15; i++) json.nodes.push({ mesh: 0 });
      },
    ],
    [
      'too-large',
      /nodes show splats in 50000 places; at most 16384 are read/,
      (json) => {
        json.meshes[0].primitives = new Array(50_000).fill({ ...primitiveOf(json), attributes: {} });
      },
    ],
    ['too-large', /JSON may have \d+ values/, (json) => (json.extras = new Array(2 ** 20).fill(0))],
  ];
  const fixture = gltfOf(splatAttributes(randomSplats({ count: 3, shDegree: 1 })));

  test.each(cases)('%s: %s', async (code, says, change) => {
    const json = structuredClone(fixture.json);
    change(json);
    const error = await failure(glbBytes({ ...fixture, json }));
    expect(error.message).toMatch(says);
    expect(error.code).toBe(code);
  });

  test.each([
    { code: 'unknown-format', says: /version 1; version 2/, word: 1, value: 1 },
    { code: 'truncated', says: /must have 100000 bytes/, word: 2, value: 100_000 },
    { code: 'damaged', says: /first chunk/, word: 2, value: 8 },
    { code: 'damaged', says: /a chunk of 4294967295 bytes/, word: 3, value: 0xffffffff },
    { code: 'damaged', says: /first chunk is not the JSON/, word: 4, value: 7 },
    { code: 'bad-header', says: /JSON cannot be read/, word: 5, value: 0xffffffff },
    { code: 'bad-header', says: /JSON cannot be read/, word: 5, value: 0x2020202c },
  ])('a .glb whose word $word is $value: $code', async ({ code, says, word, value }) => {
    const bytes = glbBytes(fixture);
    new DataView(bytes.buffer).setUint32(4 * word, value, true);
    const error = await failure(bytes);
    expect(error.message).toMatch(says);
    expect(error.code).toBe(code);
  });

  test('a file that ends early, at every length', async () => {
    const small = gltfOf(splatAttributes(randomSplats({ count: 1, shDegree: 0 })));
    const bytes = glbBytes(small);
    const codes = new Set<string>();
    for (let length = 4; length < bytes.length; length += 97)
      codes.add((await failure(bytes.subarray(0, length))).code);
    expect([...codes]).toEqual(['truncated']);
    for (let length = 4; length < bytes.length; length++) {
      const unpack = () => unpackGlb(bytes.subarray(0, length), 'scene');
      expect(unpack).toThrow(expect.objectContaining({ code: 'truncated', place: { byte: length } }));
    }
    const base64 = Buffer.from(small.binary).toString('base64');
    const text = gltfBytes(small, `data:;base64,${base64}`);
    // Without its beginning, it is any JSON.
    for (let length = 30; length < text.length; length += 97)
      codes.add((await failure(text.subarray(0, length))).code);
    expect([...codes]).toEqual(['truncated', 'bad-header']);
  });
});
