import { writeSplats } from '@websplatter/core/write';
import { MeshoptEncoder } from 'meshoptimizer/encoder';
import { type GLTF, GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { type Group, Mesh } from 'three/webgpu';
import { expect, it, vi } from 'vitest';
import { splatSetAt } from '../testing/test-clouds.ts';
import { SplatGltfPlugin } from './gltf-plugin.ts';
import { SplatCloudObject } from './splat-cloud-object.ts';
import { SplatLoader } from './splat-loader.ts';

/** Three splats at a third of a metre each. */
const SET = splatSetAt([1, 0, 0], [0, 2, 0], [0, 0, 3]);

/** The parts of a glTF's JSON that tests change. */
interface Json {
  nodes: { mesh: number; translation?: number[] }[];
  scenes: { nodes: number[] }[];
  meshes: { name?: string; primitives: Primitive[] }[];
}

interface Primitive {
  attributes: Record<string, number>;
  extensions?: { KHR_gaussian_splatting: { kernel: string } };
}

/** A binary glTF of SET, as core writes it, but for `change`. */
async function glb(change: (json: Json) => void = () => {}): Promise<ArrayBuffer> {
  const bytes = Buffer.from(await writeSplats(SET, 'gltf'));
  const binaryAt = 20 + bytes.readUint32LE(12);
  const json: Json = JSON.parse(bytes.toString('utf8', 20, binaryAt));
  change(json);
  const text = Buffer.from(JSON.stringify(json));
  const spaces = Buffer.alloc(-text.length & 3, ' ');
  const changed = Buffer.concat([bytes.subarray(0, 20), text, spaces, bytes.subarray(binaryAt)]);
  changed.writeUint32LE(changed.length, 8);
  changed.writeUint32LE(text.length + spaces.length, 12);
  return Uint8Array.from(changed).buffer;
}

function glbOf(json: object, binary: Buffer): ArrayBuffer {
  const chunk = (type: number, content: Buffer, padding: string) => {
    const padded = Buffer.concat([content, Buffer.alloc(-content.length & 3, padding)]);
    const head = Buffer.alloc(8);
    head.writeUint32LE(padded.length, 0);
    head.writeUint32LE(type, 4);
    return Buffer.concat([head, padded]);
  };
  const chunks = Buffer.concat([
    chunk(0x4e4f534a, Buffer.from(JSON.stringify(json)), ' '),
    chunk(0x004e4942, binary, '\0'),
  ]);
  const head = Buffer.alloc(12);
  for (const [i, word] of [0x46546c67, 2, 12 + chunks.length].entries()) head.writeUint32LE(word, 4 * i);
  return Uint8Array.from(Buffer.concat([head, chunks])).buffer;
}

function load(file: ArrayBuffer, splats?: SplatLoader): Promise<GLTF> {
  const loader = new GLTFLoader().register((parser) => new SplatGltfPlugin(parser, splats));
  return loader.parseAsync(file, '');
}

function cloudsIn(scene: Group): SplatCloudObject[] {
  const clouds: SplatCloudObject[] = [];
  scene.traverse((object) => {
    if (object instanceof SplatCloudObject) clouds.push(object);
  });
  return clouds;
}

it('makes a cloud of a mesh of splats, where its node puts it', async () => {
  const { scene, parser } = await load(
    await glb((json) => {
      json.nodes[0].translation = [0, 5, 0];
      json.meshes[0].name = 'robot';
    }),
  );
  const [cloud] = cloudsIn(scene);
  expect(cloud.name).toBe('robot');
  expect(cloud.data).toMatchObject({
    count: 3,
    bounds: { min: { x: 0, y: 0, z: 0 }, max: { x: 1, y: 2, z: 3 } },
  });
  expect(parser.associations.get(cloud)).toMatchObject({ meshes: 0 });
  cloud.updateWorldMatrix(true, false);
  expect(cloud.matrixWorld.elements[13]).toBe(5);
});

it('shares the splats of a mesh that several nodes show', async () => {
  const { scene } = await load(
    await glb((json) => {
      json.nodes = [{ mesh: 0 }, { mesh: 0, translation: [3, 0, 0] }];
      json.scenes[0].nodes = [0, 1];
    }),
  );
  const [a, b] = cloudsIn(scene);
  expect(a.data).toBe(b.data);
  expect(b.position.x - a.position.x).toBe(3);
});

it('keeps other geometry of the mesh, and other meshes', async () => {
  const { scene, parser } = await load(
    await glb((json) => {
      const triangle = { attributes: { POSITION: json.meshes[0].primitives[0].attributes.POSITION } };
      json.meshes = [{ primitives: [...json.meshes[0].primitives, triangle] }, { primitives: [triangle] }];
      json.nodes.push({ mesh: 1 });
      json.scenes[0].nodes.push(json.nodes.length - 1);
    }),
  );
  const meshes: Mesh[] = [];
  scene.traverse((object) => {
    if (object instanceof Mesh && !(object instanceof SplatCloudObject) && parser.associations.has(object))
      meshes.push(object);
  });
  expect(cloudsIn(scene)).toHaveLength(1);
  expect(meshes.map((mesh) => mesh.geometry.getAttribute('position').count)).toEqual([3, 3]);
});

it('reads by the loader that it is given, and rejects with its errors', async () => {
  const loader = new SplatLoader();
  const loadAsync = vi.spyOn(loader, 'loadAsync');
  await load(await glb(), loader);
  expect(loadAsync).toHaveBeenCalledTimes(1);
  const damaged = glb((json) => {
    json.meshes[0].primitives[0].extensions!.KHR_gaussian_splatting.kernel = 'box';
  });
  await expect(load(await damaged)).rejects.toThrow(/kernel/);
});

/** @fault Files: a glTF of Cesium's first tiles, or one packed by meshopt */
it('unpacks bufferViews of meshopt without the decoder that three asks for', async () => {
  await MeshoptEncoder.ready;
  const bytes = Buffer.from(await glb());
  const binaryAt = 20 + bytes.readUint32LE(12);
  const json = JSON.parse(bytes.toString('utf8', 20, binaryAt));
  const parts: Uint8Array[] = [];
  let packedAt = 0;
  json.bufferViews = json.bufferViews.map((view: { byteOffset?: number; byteLength: number }) => {
    const { byteOffset = 0, byteLength } = view;
    const place = { count: SET.count, byteStride: byteLength / SET.count, mode: 'ATTRIBUTES' };
    const start = binaryAt + 8 + byteOffset;
    const source = Uint8Array.from(bytes.subarray(start, start + byteLength));
    const part = MeshoptEncoder.encodeGltfBuffer(source, place.count, place.byteStride, place.mode);
    parts.push(part);
    packedAt += part.length;
    const packed = { buffer: 0, byteOffset: packedAt - part.length, byteLength: part.length, ...place };
    return { buffer: 1, byteLength, extensions: { EXT_meshopt_compression: packed } };
  });
  const { byteLength } = json.buffers[0];
  json.buffers = [
    { byteLength: packedAt },
    { byteLength, extensions: { EXT_meshopt_compression: { fallback: true } } },
  ];
  json.extensionsRequired = ['EXT_meshopt_compression'];
  const { scene } = await load(glbOf(json, Buffer.concat(parts)));
  const [cloud] = cloudsIn(scene);
  expect(cloud.data).toMatchObject({ count: 3, bounds: { max: { x: 1, y: 2, z: 3 } } });
});
