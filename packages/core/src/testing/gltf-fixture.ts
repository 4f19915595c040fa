import { SH_REST_COEFFICIENTS, type SplatSet } from '../data/splats/splat-set.ts';
import { randomSplats } from './random-splats.ts';

/** JSON of a glTF, to be changed at will. */
// biome-ignore lint/suspicious/noExplicitAny: tests change any part of it to anything
export type AnyJson = any;

export interface GltfFixture {
  readonly json: AnyJson;
  readonly binary: Uint8Array<ArrayBuffer>;
}

type Values = Float32Array | Int8Array | Uint8Array | Int16Array | Uint16Array;

/** Values of an attribute, row after row. */
export interface FixtureAttribute {
  readonly values: Values;
  readonly size: 1 | 3 | 4;
  readonly isNormalized?: boolean;
}

const COMPONENT_TYPES = new Map<unknown, number>([
  [Int8Array, 5120],
  [Uint8Array, 5121],
  [Int16Array, 5122],
  [Uint16Array, 5123],
  [Float32Array, 5126],
]);
const EXTENSION = 'KHR_gaussian_splatting';
export const SPZ_EXTENSION = 'KHR_gaussian_splatting_compression_spz_2';

/** Attributes of splats as the extension wants them, all of them float32. */
export function splatAttributes(set: SplatSet): Record<string, FixtureAttribute> {
  const { count, harmonics } = set;
  const floats = (size: 1 | 3 | 4, value: (row: number, i: number) => number): FixtureAttribute => ({
    size,
    values: Float32Array.from({ length: size * count }, (_, i) => value(Math.floor(i / size), i % size)),
  });
  const coefficients = SH_REST_COEFFICIENTS[harmonics.degree];
  const attributes: Record<string, FixtureAttribute> = {
    POSITION: floats(3, (row, i) => set.positions[3 * row + i] + set.origin[i]),
    [`${EXTENSION}:ROTATION`]: floats(4, (row, i) => set.rotations[4 * row + ((i + 1) % 4)]),
    [`${EXTENSION}:SCALE`]: floats(3, (row, i) => Math.exp(set.logScales[3 * row + i])),
    [`${EXTENSION}:OPACITY`]: floats(1, (row) => 1 / (1 + Math.exp(-set.opacityLogits[row]))),
    [`${EXTENSION}:SH_DEGREE_0_COEF_0`]: floats(3, (row, i) => set.colorDc[3 * row + i]),
  };
  for (let l = 1, k = 0; l <= harmonics.degree; l++) {
    for (let n = 0; n <= 2 * l; n++, k++) {
      const first = 3 * k;
      attributes[`${EXTENSION}:SH_DEGREE_${l}_COEF_${n}`] = floats(
        3,
        (row, i) => harmonics.coefficients[3 * coefficients * row + first + i],
      );
    }
  }
  return attributes;
}

/** A glTF whose only node shows splats. Attributes follow one another unless `isInterleaved`. */
export function gltfOf(attributes: Record<string, FixtureAttribute>, isInterleaved = false): GltfFixture {
  const entries = Object.entries(attributes);
  const rowBytes = ({ values, size }: FixtureAttribute) =>
    4 * Math.ceil((size * values.BYTES_PER_ELEMENT) / 4);
  const count = entries[0][1].values.length / entries[0][1].size;
  const strideBytes = entries.reduce((sum, [, attribute]) => sum + rowBytes(attribute), 0);
  const binary = new Uint8Array(count * strideBytes);
  const bufferViews: AnyJson[] = isInterleaved
    ? [{ buffer: 0, byteLength: binary.length, byteStride: strideBytes }]
    : [];
  const accessors: AnyJson[] = [];
  const semantics: Record<string, number> = {};
  let place = 0;
  for (const [semantic, attribute] of entries) {
    const { values, size, isNormalized } = attribute;
    const bytes = new Uint8Array(values.buffer);
    const own = size * values.BYTES_PER_ELEMENT;
    const from = isInterleaved ? place : place * count;
    const step = isInterleaved ? strideBytes : rowBytes(attribute);
    for (let row = 0; row < count; row++)
      binary.set(bytes.subarray(row * own, (row + 1) * own), from + row * step);
    if (!isInterleaved) {
      const view = { buffer: 0, byteOffset: from, byteLength: count * step };
      bufferViews.push(step === own ? view : { ...view, byteStride: step });
    }
    semantics[semantic] = accessors.length;
    accessors.push({
      bufferView: bufferViews.length - 1,
      ...(isInterleaved && { byteOffset: from }),
      componentType: COMPONENT_TYPES.get(values.constructor),
      ...(isNormalized && { normalized: true }),
      count,
      type: size === 1 ? 'SCALAR' : `VEC${size}`,
    });
    place += rowBytes(attribute);
  }
  const json = {
    asset: { version: '2.0' },
    extensionsUsed: [EXTENSION],
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [
      {
        primitives: [
          {
            mode: 0,
            attributes: semantics,
            extensions: { [EXTENSION]: { kernel: 'ellipse', colorSpace: 'srgb_rec709_display' } },
          },
        ],
      },
    ],
    buffers: [{ byteLength: binary.length }],
    bufferViews,
    accessors,
  };
  return { json, binary };
}

/** The file as one binary glTF. */
export function glbBytes({ json, binary }: GltfFixture): Uint8Array<ArrayBuffer> {
  return glbOfText(JSON.stringify(json), binary);
}

/** A binary glTF of any text as its JSON. */
export function glbOfText(json: string, binary: Uint8Array): Uint8Array<ArrayBuffer> {
  const text = new TextEncoder().encode(json);
  const jsonLength = 4 * Math.ceil(text.length / 4);
  const bytes = new Uint8Array(12 + 8 + jsonLength + 8 + binary.length).fill(0x20);
  const view = new DataView(bytes.buffer);
  [0x46546c67, 2, bytes.length, jsonLength, 0x4e4f534a].forEach((word, i) => {
    view.setUint32(4 * i, word, true);
  });
  bytes.set(text, 20);
  view.setUint32(20 + jsonLength, binary.length, true);
  view.setUint32(24 + jsonLength, 0x004e4942, true);
  bytes.set(binary, 28 + jsonLength);
  return bytes;
}

/** A file whose primitives are all the same .spz, and nothing else. */
export function glbOfSpz(
  packed: Uint8Array,
  primitiveCount = 1,
  name = SPZ_EXTENSION,
  extensions: object = { [EXTENSION]: { extensions: { [name]: { bufferView: 0 } } } },
): Uint8Array<ArrayBuffer> {
  const { json } = gltfOf(splatAttributes(randomSplats({ count: 1, shDegree: 0 })));
  json.extensionsRequired = [EXTENSION, name];
  const primitive = {
    mode: 0,
    attributes: {},
    extensions,
  };
  json.meshes[0].primitives = Array.from({ length: primitiveCount }, () => primitive);
  json.accessors = [];
  json.bufferViews = [{ buffer: 0, byteLength: packed.length }];
  json.buffers = [{ byteLength: packed.length }];
  return glbBytes({ json, binary: Uint8Array.from(packed) });
}

/** The file as JSON, whose buffer is elsewhere. */
export function gltfBytes({ json }: GltfFixture, uri: string): Uint8Array<ArrayBuffer> {
  const buffers = [{ ...json.buffers[0], uri }];
  return new TextEncoder().encode(JSON.stringify({ ...json, buffers }));
}
