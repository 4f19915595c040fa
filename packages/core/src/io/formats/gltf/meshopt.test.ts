import { MeshoptEncoder } from 'meshoptimizer/encoder';
import { describe, expect, test } from 'vitest';
import { SplatFileError } from '../../../data/errors.ts';
import { expectSamePicture } from '../../../testing/expect-same-picture.ts';
import { fileErrorOf } from '../../../testing/file-error-of.ts';
import { fuzz } from '../../../testing/fuzz.ts';
import { type AnyJson, glbBytes, gltfOf, splatAttributes } from '../../../testing/gltf-fixture.ts';
import { type MeshoptOptions, meshoptPacked } from '../../../testing/meshopt-fixture.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { damagedBytes, outcomeOf } from '../../../testing/read-damaged.ts';
import type { PackedView } from '../../containers/meshopt.ts';
import { decodeHere } from '../../loading/meshopt-on-page.ts';
import { readSplats } from '../../loading/read-splats.ts';

const set = randomSplats({ count: 333, shDegree: 2, halfExtent: 0.6 });
/** Unit rotations, as the filter for quaternions keeps them. */
for (let i = 0; i < set.count; i++) {
  const q = set.rotations.subarray(4 * i, 4 * i + 4);
  const length = Math.hypot(...q);
  for (let k = 0; k < 4; k++) q[k] /= length;
}
const plain = gltfOf(splatAttributes(set));

const read = (bytes: Uint8Array, maxBytes?: number) =>
  readSplats(bytes, { shPrecision: 'f32', name: 'scene', maxBytes });
const packedGlb = async (options?: MeshoptOptions, fixture = plain) =>
  glbBytes(await meshoptPacked(fixture, options));

/**
 * @fault Files: a glTF of Cesium's first tiles, or one packed by meshopt
 * @consequence read; the page fetches the decoder when a file needs it
 */
describe('bufferViews that meshopt has packed', () => {
  test.each<MeshoptOptions>([
    {},
    { version: 1 },
    { extension: 'KHR_meshopt_compression', version: 1 },
    { hasFallback: false },
  ])('without filters, bit by bit: %j', async (options) => {
    const file = await packedGlb(options);
    expect(await read(file)).toEqual(await read(glbBytes(plain)));
  });

  test('that several attributes share', async () => {
    const interleaved = gltfOf(splatAttributes(set), true);
    expect(await read(await packedGlb({}, interleaved))).toEqual(await read(glbBytes(interleaved)));
  });

  test.each(['EXT_meshopt_compression', 'KHR_meshopt_compression'] as const)(
    'with the filters for exponents and quaternions: %s',
    async (extension) => {
      // Rotations are the second attribute.
      const filterOf = (view: number) => (view === 1 ? 'QUATERNION' : 'EXPONENTIAL');
      const found = await read(await packedGlb({ extension, filterOf }));
      expect(found).toMatchObject({ count: set.count, dropped: {} });
      expectSamePicture(found, await read(glbBytes(plain)), 80);
    },
  );

  test('required, but of no bufferView', async () => {
    const json = structuredClone(plain.json);
    json.extensionsRequired = ['EXT_meshopt_compression'];
    const found = await read(glbBytes({ ...plain, json }));
    expect(found).toEqual(await read(glbBytes(plain)));
  });
});

describe('every mode and filter is undone', () => {
  const floats = Float32Array.from({ length: 48 }, (_, i) => Math.sin(i + 1));
  const unit = floats.map((value, i) => value / Math.hypot(...floats.subarray(i & ~3, (i & ~3) + 4)));
  const decoded = async (
    source: Uint8Array,
    count: number,
    strideBytes: number,
    mode: PackedView['mode'],
    filter: PackedView['filter'],
  ) => {
    const bytes = Uint8Array.from(MeshoptEncoder.encodeGltfBuffer(source, count, strideBytes, mode));
    return (await decodeHere({ bytes, count, strideBytes, mode, filter }))!;
  };
  const worst = (found: ArrayLike<number>, expected: ArrayLike<number>) =>
    Array.from(found).reduce((most, value, i) => Math.max(most, Math.abs(value - expected[i])), 0);

  test('triangles and indices, of 16 and 32 bits', async () => {
    await MeshoptEncoder.ready;
    const indices = [0, 1, 2, 2, 1, 3, 3, 1, 4, 4, 1, 5];
    for (const mode of ['TRIANGLES', 'INDICES'] as const)
      for (const Values of [Uint16Array, Uint32Array]) {
        const source = new Uint8Array(Values.from(indices).buffer);
        const found = await decoded(source, 12, Values.BYTES_PER_ELEMENT, mode, 'NONE');
        expect([...new Values(found.buffer)]).toEqual(indices);
      }
  });

  test('octahedra, quaternions, exponents and colours', async () => {
    await MeshoptEncoder.ready;
    const oct = await decoded(
      MeshoptEncoder.encodeFilterOct(unit, 12, 8, 16),
      12,
      8,
      'ATTRIBUTES',
      'OCTAHEDRAL',
    );
    const normals = unit.map((value, i) => value / Math.hypot(...unit.subarray(i & ~3, (i & ~3) + 3)));
    const three = (values: ArrayLike<number>) => Array.from(values).filter((_, i) => i % 4 < 3);
    expect(
      worst(three(new Int16Array(oct.buffer).map((value) => value)), three(normals.map((v) => v * 32767))),
    ).toBeLessThan(4);
    const quat = await decoded(
      MeshoptEncoder.encodeFilterQuat(unit, 12, 8, 16),
      12,
      8,
      'ATTRIBUTES',
      'QUATERNION',
    );
    const turned = new Int16Array(quat.buffer);
    for (let i = 0; i < 48; i += 4) {
      // q and −q are one rotation.
      const dot = [0, 1, 2, 3].reduce((sum, k) => sum + (turned[i + k] / 32767) * unit[i + k], 0);
      expect(Math.abs(dot)).toBeCloseTo(1, 4);
    }
    const exp = await decoded(
      MeshoptEncoder.encodeFilterExp(floats, 12, 16, 24),
      12,
      16,
      'ATTRIBUTES',
      'EXPONENTIAL',
    );
    expect(worst(new Float32Array(exp.buffer), floats)).toBeLessThan(1e-6);
    const colors = floats.map(Math.abs);
    const color = await decoded(
      MeshoptEncoder.encodeFilterColor(colors, 12, 8, 16),
      12,
      8,
      'ATTRIBUTES',
      'COLOR',
    );
    expect(
      worst(
        new Uint16Array(color.buffer),
        colors.map((value) => value * 65535),
      ),
    ).toBeLessThan(8);
  });
});

/**
 * @fault Files: views that claim to be packed by meshopt, damaged or impossible
 * @consequence `SplatFileError` that names the view; without WebAssembly a `CodeUnavailableError`
 */
describe('files that are refused', () => {
  /** The error of a file whose first view's extension is changed. */
  const refusal = async (change: (packed: AnyJson, view: AnyJson) => void) => {
    const fixture = await meshoptPacked(plain);
    const [view] = fixture.json.bufferViews;
    change(view.extensions.EXT_meshopt_compression, view);
    return fileErrorOf(read(glbBytes(fixture)));
  };

  test.each<[string, RegExp, (packed: AnyJson, view: AnyJson) => void]>([
    [
      'bad-property',
      /the mode of bufferViews\[0\] is SPLATS; meshopt has ATTRIBUTES/,
      (packed) => (packed.mode = 'SPLATS'),
    ],
    ['bad-property', /the filter of bufferViews\[0\] is 7/, (packed) => (packed.filter = 7)],
    ['bad-property', /the mode .* is toString/, (packed) => (packed.mode = 'toString')],
    [
      'bad-property',
      /333 elements of 12 bytes, ATTRIBUTES, filter QUATERNION/,
      (packed) => (packed.filter = 'QUATERNION'),
    ],
    ['bad-property', /333 elements of 13 bytes/, (packed) => (packed.byteStride = 13)],
    ['bad-property', /of 12 bytes, TRIANGLES/, (packed) => (packed.mode = 'TRIANGLES')],
    ['bad-header', /count of bufferViews\[0\]/, (packed) => (packed.count = -1)],
    ['bad-header', /byteLength of bufferViews\[0\] is undefined/, (packed) => delete packed.byteLength],
    ['damaged', /has 3996 bytes, and unpacks to 3984/, (packed) => (packed.count = 332)],
    ['damaged', /refers to buffers\[9\]/, (packed) => (packed.buffer = 9)],
    ['damaged', /bytes 0 to 99999 of a buffer/, (packed) => (packed.byteLength = 99999)],
    ['damaged', /bufferViews\[0\] cannot be unpacked by meshopt/, (packed) => packed.byteLength--],
    [
      'too-large',
      /unpacks to 12000000000 bytes; at most/,
      (packed, view) => {
        packed.count = 1e9;
        view.byteLength = 12e9;
      },
    ],
    [
      'too-large',
      /bufferViews unpack to 1068000000 bytes or more/,
      (packed, view) => {
        packed.count = 89e6;
        view.byteLength = 1068e6;
      },
    ],
  ])('%s: %s', async (code, message, change) => {
    const error = await refusal(change);
    expect(error).toBeInstanceOf(SplatFileError);
    expect(error.message).toMatch(message);
    expect(error.code).toBe(code);
  });

  test('a view that something else has packed is named', async () => {
    const json = structuredClone(plain.json);
    json.buffers.push({ byteLength: 36 });
    json.bufferViews[0] = { buffer: 1, byteLength: 36, extensions: { EXT_other_compression: {} } };
    const error = await fileErrorOf(read(glbBytes({ ...plain, json })));
    expect(error.message).toContain('packed by EXT_other_compression, which is not read');
  });

  test('any damage gives splats or a typed error', { tags: 'deeper' }, async () => {
    const files = [
      await packedGlb(),
      await packedGlb({ filterOf: (view) => (view === 1 ? 'QUATERNION' : 'EXPONENTIAL') }),
    ];
    await fuzz({ few: 60, many: 1500 }, async (choices) => {
      const outcome = outcomeOf(damagedBytes(choices.of(files), choices), 'scene.glb');
      // Every other error is thrown.
      await expect(outcome).resolves.toBeDefined();
    });
  });
});
