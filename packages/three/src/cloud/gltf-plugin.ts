import { Group, type LoadingManager, type Object3D } from 'three/webgpu';
import { SplatCloudObject } from './splat-cloud-object.ts';
import type { SplatData } from './splat-data.ts';
import { SplatLoader } from './splat-loader.ts';

const SPLATTING = 'KHR_gaussian_splatting';
/** Extensions of primitives that are splats; early tiles of Cesium use the second. */
const OF_SPLATS = [SPLATTING, 'KHR_spz_gaussian_splats_compression'];
/** Extensions of bufferViews that core unpacks, without the decoder that three asks for. */
const MESHOPT = ['KHR_meshopt_compression', 'EXT_meshopt_compression'];
/** Chunks of a binary glTF: their types, and the multiple of bytes that each fills. */
const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;
const CHUNK_ALIGNMENT = 4;
/** Large enough for every type of component. */
const VIEW_ALIGNMENT = 8;

/** The parser of three's GLTFLoader, or of another that is like it, such as the one that drei has. */
export interface GltfParser {
  readonly json: unknown;
  readonly options: { readonly manager: LoadingManager };
  readonly associations: { set(object: Object3D, places: object): unknown };
  getDependency(type: string, index: number): Promise<unknown>;
  loadMesh(index: number): Promise<Object3D>;
}

/** The parts of a glTF's JSON that place splats. */
interface GltfJson {
  readonly asset: object;
  readonly meshes: readonly GltfMesh[];
  readonly accessors?: readonly { readonly bufferView?: number }[];
  readonly bufferViews?: readonly GltfView[];
}

interface GltfView {
  readonly byteLength: number;
  readonly byteStride?: number;
  readonly extensions?: Readonly<Record<string, PackedBytes>>;
}

/** The place of a view's packed bytes in a buffer. */
interface PackedBytes {
  readonly buffer: number;
  readonly byteOffset?: number;
  readonly byteLength: number;
}

interface GltfMesh {
  readonly name?: string;
  primitives: readonly GltfPrimitive[];
}

interface GltfPrimitive {
  readonly attributes?: Readonly<Record<string, number>>;
  readonly extensions?: Readonly<Record<string, object>>;
}

/**
 * Shows the splats of glTF files (KHR_gaussian_splatting) that three's GLTFLoader loads. Each mesh
 * with splats becomes a `SplatCloudObject` in the scene, or a Group if it also has other geometry.
 * Supports the same extensions as core's reader of glTF.
 *
 * Loads reject with the errors of `SplatLoader.load`.
 *
 * @example
 * const loader = new GLTFLoader().register((parser) => new SplatGltfPlugin(parser));
 * scene.add((await loader.loadAsync('/room.glb')).scene);
 */
export class SplatGltfPlugin {
  /** The extension's name: replaces three's own plugin for it. */
  readonly name = SPLATTING;
  readonly #parser: GltfParser;
  readonly #loader: SplatLoader;

  /** @param loader reads the splats: with a renderer, an accuracy or limits of its own. */
  constructor(parser: GltfParser, loader = new SplatLoader(parser.options.manager)) {
    this.#parser = parser;
    this.#loader = loader;
  }

  /** Called by three: returns null for a mesh without splats. */
  loadMesh(index: number): Promise<Group> | null {
    const { meshes } = this.#parser.json as GltfJson;
    if (!meshes[index].primitives.some(isOfSplats)) return null;
    return this.#objectOf(meshes[index], index) as Promise<Group>;
  }

  /** Makes the object of a mesh's splats; for subclasses with a class of their own. */
  protected makeCloud(data: SplatData): SplatCloudObject {
    return new SplatCloudObject(data);
  }

  async #objectOf(mesh: GltfMesh, index: number): Promise<Object3D> {
    const { primitives } = mesh;
    const others = primitives.filter((primitive) => !isOfSplats(primitive));
    // three's own way to load a mesh takes all of its primitives.
    mesh.primitives = others;
    const loadsOthers = others.length > 0 ? this.#parser.loadMesh(index) : null;
    mesh.primitives = primitives;
    const file = await this.#fileOf(primitives.filter(isOfSplats));
    const cloud = this.makeCloud(await this.#loader.loadAsync(file));
    cloud.name = mesh.name ?? `mesh_${index}`;
    this.#parser.associations.set(cloud, { meshes: index });
    return loadsOthers ? new Group().add(cloud, await loadsOthers) : cloud;
  }

  /** Makes a binary glTF of nothing but these primitives, with the buffers that three has fetched. */
  async #fileOf(primitives: readonly GltfPrimitive[]): Promise<Blob> {
    const json = this.#parser.json as GltfJson;
    const { accessors = [], bufferViews = [] } = json;
    const used = new Set(primitives.flatMap((primitive) => viewsOf(primitive, accessors)));
    const bytes: BlobPart[] = [];
    const views: object[] = bufferViews.map(() => ({ buffer: 0, byteLength: 1 }));
    let byteOffset = 0;
    for (const view of used) {
      const { byteStride, byteLength, extensions = {} } = bufferViews[view];
      const meshopt = MESHOPT.find((name) => extensions[name]);
      const buffer = await this.#bytesOf(view, meshopt ? extensions[meshopt] : undefined);
      const padding = -buffer.byteLength & (VIEW_ALIGNMENT - 1);
      views[view] = meshopt
        ? {
            ...{ buffer: 0, byteLength, byteStride },
            extensions: { [meshopt]: { ...extensions[meshopt], buffer: 0, byteOffset } },
          }
        : { buffer: 0, byteOffset, byteLength: buffer.byteLength, byteStride };
      bytes.push(buffer, new Uint8Array(padding));
      byteOffset += buffer.byteLength + padding;
    }
    const contents = {
      asset: json.asset,
      scene: 0,
      scenes: [{ nodes: [0] }],
      nodes: [{ mesh: 0 }],
      meshes: [{ primitives }],
      accessors,
      bufferViews: views,
      buffers: [{ byteLength: byteOffset }],
    };
    const text = new TextEncoder().encode(JSON.stringify(contents));
    const spaces = new Uint8Array(-text.byteLength & (CHUNK_ALIGNMENT - 1)).fill(0x20);
    const textBytes = text.byteLength + spaces.byteLength;
    const head = Uint32Array.of(MAGIC, 2, 28 + textBytes + byteOffset, textBytes, JSON_CHUNK);
    const parts = [head, text, spaces, Uint32Array.of(byteOffset, BINARY_CHUNK), ...bytes];
    return new Blob(parts as BlobPart[]);
  }

  /** The bytes of a bufferView; its packed bytes if it is packed. */
  async #bytesOf(view: number, packed: PackedBytes | undefined): Promise<ArrayBuffer> {
    if (!packed) return (await this.#parser.getDependency('bufferView', view)) as ArrayBuffer;
    const { byteOffset = 0, byteLength } = packed;
    const buffer = (await this.#parser.getDependency('buffer', packed.buffer)) as ArrayBuffer;
    return buffer.slice(byteOffset, byteOffset + byteLength);
  }
}

function isOfSplats({ extensions }: GltfPrimitive): boolean {
  return OF_SPLATS.some((name) => extensions?.[name] !== undefined);
}

/** Indices of the bufferViews of a primitive's attributes and extensions. */
function viewsOf(primitive: GltfPrimitive, accessors: NonNullable<GltfJson['accessors']>): number[] {
  const ofAttributes = Object.values(primitive.attributes ?? {}).flatMap(
    (accessor) => accessors[accessor]?.bufferView ?? [],
  );
  return [...ofAttributes, ...namedViews(primitive.extensions)];
}

function namedViews(value: unknown): number[] {
  if (typeof value !== 'object' || value === null) return [];
  return Object.entries(value).flatMap(([key, each]) =>
    key === 'bufferView' && typeof each === 'number' ? [each] : namedViews(each),
  );
}
