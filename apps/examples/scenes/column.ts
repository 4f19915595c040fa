import { writeSplats } from '@websplatter/core/write';
import { ring } from './ring.ts';

/** Size of a column on the y axis, and the number of its sides. */
const RADIUS = 0.16;
const HEIGHT = 1.6;
const SIDES = 24;

const HEADER_BYTES = 12;
const CHUNK_HEADER_BYTES = 8;

/** Returns a glTF with a horizontal ring of splats around a column, which is a mesh. */
export async function columnGlb(): Promise<Uint8Array> {
  const splats = await writeSplats(ring(), 'gltf');
  const view = new DataView(splats.buffer, splats.byteOffset);
  const jsonAt = HEADER_BYTES + CHUNK_HEADER_BYTES;
  const binaryAt = jsonAt + view.getUint32(HEADER_BYTES, true) + CHUNK_HEADER_BYTES;
  const json = JSON.parse(new TextDecoder().decode(splats.subarray(jsonAt, binaryAt - CHUNK_HEADER_BYTES)));
  const binary = splats.subarray(binaryAt);
  const column = corners();
  const count = column.length / 6;
  const [byteView, accessor] = [json.bufferViews.length, json.accessors.length];
  json.buffers[0].byteLength = binary.byteLength + column.byteLength;
  json.bufferViews.push({
    buffer: 0,
    byteOffset: binary.byteLength,
    byteLength: column.byteLength,
    byteStride: 24,
  });
  json.accessors.push(
    {
      ...{ bufferView: byteView, componentType: 5126, count, type: 'VEC3' },
      min: [-RADIUS, -HEIGHT / 2, -RADIUS],
      max: [RADIUS, HEIGHT / 2, RADIUS],
    },
    { bufferView: byteView, byteOffset: 12, componentType: 5126, count, type: 'VEC3' },
  );
  json.materials = [{ pbrMetallicRoughness: { baseColorFactor: [0.8, 0.78, 0.72, 1], metallicFactor: 0 } }];
  json.meshes.push({
    name: 'column',
    primitives: [{ attributes: { POSITION: accessor, NORMAL: accessor + 1 }, material: 0 }],
  });
  // A quarter turn about x lays the ring flat.
  json.nodes = [{ mesh: 0, rotation: [Math.SQRT1_2, 0, 0, Math.SQRT1_2] }, { mesh: json.meshes.length - 1 }];
  json.scenes[0].nodes = [0, 1];
  return glb(json, [binary, new Uint8Array(column.buffer)]);
}

/** Triangles of the column's side and top: position and normal of each vertex. */
function corners(): Float32Array<ArrayBuffer> {
  const values: number[] = [];
  for (let side = 0; side < SIDES; side++) {
    const [from, to] = [side, side + 1].map((each) => (2 * Math.PI * each) / SIDES);
    const at = (angle: number, y: number) => [RADIUS * Math.sin(angle), y, RADIUS * Math.cos(angle)];
    const out = (angle: number) => [Math.sin(angle), 0, Math.cos(angle)];
    const [low, high] = [-HEIGHT / 2, HEIGHT / 2];
    for (const [angle, y] of [
      [from, low],
      [to, low],
      [to, high],
      [from, low],
      [to, high],
      [from, high],
    ])
      values.push(...at(angle, y), ...out(angle));
    for (const point of [[0, high, 0], at(from, high), at(to, high)]) values.push(...point, 0, 1, 0);
  }
  return Float32Array.from(values);
}

function glb(json: object, binary: readonly Uint8Array[]): Uint8Array {
  const text = new TextEncoder().encode(JSON.stringify(json));
  const textBytes = Math.ceil(text.length / 4) * 4;
  const binaryBytes = binary.reduce((sum, { length }) => sum + length, 0);
  const bytes = new Uint8Array(HEADER_BYTES + 2 * CHUNK_HEADER_BYTES + textBytes + binaryBytes).fill(0x20);
  const words = new DataView(bytes.buffer);
  [0x46546c67, 2, bytes.length, textBytes, 0x4e4f534a].forEach((word, i) => {
    words.setUint32(4 * i, word, true);
  });
  const binaryAt = HEADER_BYTES + CHUNK_HEADER_BYTES + textBytes;
  bytes.set(text, HEADER_BYTES + CHUNK_HEADER_BYTES);
  words.setUint32(binaryAt, binaryBytes, true);
  words.setUint32(binaryAt + 4, 0x004e4942, true);
  let at = binaryAt + CHUNK_HEADER_BYTES;
  for (const part of binary) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}
