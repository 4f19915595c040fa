import { verticalFov } from '@websplatter/kit/vertical-fov';
import { shorterSideFov } from '../camera/orbit-near.ts';
import { axesOf, type CameraAxes, type Quaternion, quaternionOf } from '../camera/rotation.ts';
import { isFiniteF32 } from '../state/float32.ts';
import { hermite } from '../state/hermite.ts';
import { add, clamp, cross, normalize, scale, type Vec3 } from '../state/vec3.ts';
import { type FileKey, type FilePath, PathFileError, type PathScene, poseInScene } from './path-file.ts';

/** glTF is y up; a drawn scene may have z up. */
const toGltf = ([x, y, z]: Vec3, isZUp: boolean): Vec3 => (isZUp ? [x, z, 0 - y] : [x, y, z]);
const fromGltf = ([x, y, z]: Vec3, isZUp: boolean): Vec3 => (isZUp ? [x, 0 - z, y] : [x, y, z]);

const GLB_MAGIC = 0x46546c67;
const GLB_VERSION = 2;
const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;
const FLOAT = 5126;

/** A camera of the drawn scene at a time. */
export interface SampledCamera {
  readonly timeS: number;
  readonly position: Vec3;
  readonly axes: CameraAxes;
}

/**
 * Writes an animated camera as glTF 2.0. Its numbers are float32, which glTF demands.
 *
 * @param cameras at least one, by time; between them, players interpolate linearly.
 * @param fovDegrees over the picture's shorter side: core glTF cannot animate it.
 */
export function writeGltfPath(
  cameras: readonly SampledCamera[],
  fovDegrees: number,
  { aspect, isZUp }: Pick<PathScene, 'aspect' | 'isZUp'>,
  isBinary: boolean,
): Blob {
  const times = Float32Array.from(cameras, ({ timeS }) => timeS);
  const positions = Float32Array.from(cameras.flatMap(({ position }) => toGltf(position, isZUp)));
  let last: Quaternion = [0, 0, 0, 1];
  const turns = Float32Array.from(
    cameras.flatMap(({ axes: { right, above, back } }) => {
      const turn = quaternionOf({
        right: toGltf(right, isZUp),
        above: toGltf(above, isZUp),
        back: toGltf(back, isZUp),
      });
      // Both signs are the same turn: players that interpolate numbers need the nearer one.
      const sign = turn.reduce((sum, value, i) => sum + value * last[i], 0) < 0 ? -1 : 1;
      last = [sign * turn[0], sign * turn[1], sign * turn[2], sign * turn[3]];
      return last;
    }),
  );
  const arrays = [times, positions, turns];
  const byteLength = arrays.reduce((sum, array) => sum + array.byteLength, 0);
  let byteOffset = 0;
  const bufferViews = arrays.map((array) => {
    const view = { buffer: 0, byteOffset, byteLength: array.byteLength };
    byteOffset += array.byteLength;
    return view;
  });
  const count = cameras.length;
  const yfov = (verticalFov(fovDegrees, aspect) * Math.PI) / 180;
  const json = {
    asset: { version: '2.0', generator: 'WebSplatter' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [
      {
        ...{ name: 'Camera path', camera: 0 },
        ...{ translation: [...positions.slice(0, 3)], rotation: [...turns.slice(0, 4)] },
      },
    ],
    cameras: [{ type: 'perspective', perspective: { yfov, aspectRatio: aspect, znear: 0.01 } }],
    animations: [
      {
        name: 'Camera path',
        samplers: [
          { input: 0, output: 1, interpolation: 'LINEAR' },
          { input: 0, output: 2, interpolation: 'LINEAR' },
        ],
        channels: [
          { sampler: 0, target: { node: 0, path: 'translation' } },
          { sampler: 1, target: { node: 0, path: 'rotation' } },
        ],
      },
    ],
    accessors: [
      {
        bufferView: 0,
        componentType: FLOAT,
        count,
        type: 'SCALAR',
        min: [times[0]],
        max: [times[count - 1]],
      },
      { bufferView: 1, componentType: FLOAT, count, type: 'VEC3' },
      { bufferView: 2, componentType: FLOAT, count, type: 'VEC4' },
    ],
    bufferViews,
    buffers: [{ byteLength }],
  };
  if (!isBinary) {
    const bytes = new Uint8Array(byteLength);
    arrays.forEach((array, i) => {
      bytes.set(new Uint8Array(array.buffer), bufferViews[i].byteOffset);
    });
    const uri = `data:application/octet-stream;base64,${base64Of(bytes)}`;
    const text = JSON.stringify({ ...json, buffers: [{ byteLength, uri }] }, null, 1);
    return new Blob([text], { type: 'model/gltf+json' });
  }
  const text = new TextEncoder().encode(JSON.stringify(json));
  const spaces = new Uint8Array(-text.length & 3).fill(0x20);
  const jsonLength = text.length + spaces.length;
  const head = Uint32Array.of(GLB_MAGIC, GLB_VERSION, 28 + jsonLength + byteLength, jsonLength, JSON_CHUNK);
  const binaryHead = Uint32Array.of(byteLength, BINARY_CHUNK);
  return new Blob([head, text, spaces, binaryHead, ...arrays], { type: 'model/gltf-binary' });
}

function base64Of(bytes: Uint8Array): string {
  let text = '';
  for (let i = 0; i < bytes.length; i += 0x8000)
    text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  return btoa(text);
}

type Json = Readonly<Record<string, unknown>>;

/** The parts of a glTF file that move cameras; indices and numbers are checked when they are read. */
interface Gltf {
  readonly fileName: string;
  readonly json: Json;
  readonly binary: Uint8Array | null;
  /** What has been read, by name: many channels may refer to one accessor, and many accessors to one buffer. */
  readonly known: Map<string, unknown>;
}

/** Most nodes from a scene's root to a camera. Each is multiplied at each time. */
const MOST_ANCESTORS = 256;

interface Track {
  readonly timesS: readonly number[];
  readonly values: readonly number[];
  readonly interpolation: string;
}

/** Values of a node that move with time, by name. */
type NodeTracks = Partial<Record<'translation' | 'rotation' | 'scale', Track>>;

/**
 * Reads a camera's animation in glTF 2.0, as Blender writes it: of the first camera that moves, also
 * with its parents. If none moves, the path leads through all cameras in their order.
 *
 * @throws PathFileError naming what cannot be read.
 */
export async function readGltfPath(file: File, scene: PathScene): Promise<FilePath> {
  const gltf = await openGltf(file);
  const { fileName } = gltf;
  const nodes = list(gltf, 'nodes');
  const cameraNodes = nodes.flatMap((node, i) => (node.camera === undefined ? [] : [i]));
  if (cameraNodes.length === 0) throw new PathFileError(fileName, 'it has no node with a camera.');
  const parents = parentsOf(nodes);
  const tracks = new Map<number, NodeTracks>();
  for (const animation of list(gltf, 'animations')) readAnimation(gltf, animation, tracks);
  const chainOf = (node: number) => {
    const chain = [node];
    for (let up = parents.get(node); up !== undefined; up = parents.get(up)) {
      if (chain.includes(up)) throw new PathFileError(fileName, `node ${up} is its own ancestor.`);
      if (chain.length > MOST_ANCESTORS)
        throw new PathFileError(fileName, `node ${node} has more than ${MOST_ANCESTORS} nodes above it.`);
      chain.unshift(up);
    }
    return chain;
  };
  const moving = cameraNodes.find((node) => chainOf(node).some((each) => tracks.has(each)));
  const keyOf = (node: number, timeS: number, atMs: number): FileKey => ({
    ...cameraAt(gltf, nodes, chainOf(node), tracks, timeS, scene),
    atMs,
    name: typeof nodes[node].name === 'string' && moving === undefined ? nodes[node].name : '',
  });
  if (moving === undefined) {
    const keys = cameraNodes.map((node, i) => keyOf(node, 0, i * STILL_MS));
    return { keys, durationMs: keys.length * STILL_MS, isLooped: false, notes: [] };
  }
  const all = chainOf(moving).flatMap((node) =>
    Object.values(tracks.get(node) ?? {}).flatMap(({ timesS }) => timesS),
  );
  const timesS = [...new Set(all)].sort((a, b) => a - b);
  const keys = timesS.map((timeS) => keyOf(moving, timeS, 1000 * (timeS - timesS[0])));
  const others = cameraNodes.length - 1;
  const notes = others > 0 ? [`It has ${cameraNodes.length} cameras; the first that moves is used.`] : [];
  return { keys, durationMs: keys[keys.length - 1].atMs, isLooped: false, notes };
}

/** Time from one of several cameras that stand still to the next, ms. */
const STILL_MS = 2500;

async function openGltf(file: File): Promise<Gltf> {
  const fileName = file.name;
  const bytes = new Uint8Array(await file.arrayBuffer());
  const view = new DataView(bytes.buffer);
  const isBinary = bytes.length >= 4 && view.getUint32(0, true) === GLB_MAGIC;
  if (!isBinary) return { fileName, json: parse(fileName, bytes), binary: null, known: new Map() };
  if (bytes.length < 20 || view.getUint32(4, true) !== GLB_VERSION)
    throw new PathFileError(fileName, 'it is no glTF of version 2.');
  let json: Json | null = null;
  let binary: Uint8Array | null = null;
  for (let at = 12; at + 8 <= bytes.length; ) {
    const [length, kind] = [view.getUint32(at, true), view.getUint32(at + 4, true)];
    if (at + 8 + length > bytes.length) throw new PathFileError(fileName, 'its last bytes are missing.');
    const chunk = bytes.subarray(at + 8, at + 8 + length);
    if (kind === JSON_CHUNK) json ??= parse(fileName, chunk);
    else if (kind === BINARY_CHUNK) binary ??= chunk;
    at += 8 + length + (-length & 3);
  }
  if (!json) throw new PathFileError(fileName, 'it has no JSON.');
  return { fileName, json, binary, known: new Map() };
}

function parse(fileName: string, bytes: Uint8Array): Json {
  try {
    const json: unknown = JSON.parse(new TextDecoder().decode(bytes));
    if (isObject(json)) return json;
  } catch {
    // Said below.
  }
  throw new PathFileError(fileName, 'it is no glTF: it does not hold JSON.');
}

function isObject(value: unknown): value is Json {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/** What `read` returns, read once for each name. */
function once<T>({ known }: Gltf, name: string, read: () => T): T {
  if (!known.has(name)) known.set(name, read());
  return known.get(name) as T;
}

/** A list of objects, empty if absent. */
function list({ fileName, json }: Gltf, name: string, of: Json = json): readonly Json[] {
  const value = of[name];
  if (value === undefined) return [];
  if (Array.isArray(value) && value.every(isObject)) return value;
  throw new PathFileError(fileName, `${name} is not a list of objects.`);
}

function entry(gltf: Gltf, name: string, index: unknown, among?: readonly Json[]): Json {
  const found = (among ?? once(gltf, name, () => list(gltf, name)))[index as number];
  if (found) return found;
  throw new PathFileError(gltf.fileName, `${name}[${index}] is missing.`);
}

function numbers({ fileName }: Gltf, name: string, value: unknown, count: number): readonly number[] {
  if (Array.isArray(value) && value.length === count && value.every(isFiniteF32)) return value;
  throw new PathFileError(fileName, `${name} is not a list of ${count} numbers of float32.`);
}

function parentsOf(nodes: readonly Json[]): ReadonlyMap<number, number> {
  return new Map(
    nodes.flatMap(({ children }, i) =>
      Array.isArray(children) ? children.map((child): [number, number] => [child, i]) : [],
    ),
  );
}

function readAnimation(gltf: Gltf, animation: Json, tracks: Map<number, NodeTracks>): void {
  const samplers = list(gltf, 'samplers', animation);
  for (const { sampler, target } of list(gltf, 'channels', animation)) {
    if (!isObject(target)) continue;
    const { node, path } = target;
    if (typeof node !== 'number' || !(path === 'translation' || path === 'rotation' || path === 'scale'))
      continue;
    const { input, output, interpolation = 'LINEAR' } = entry(gltf, 'samplers', sampler, samplers);
    const timesS = timesAt(gltf, input);
    const values = accessor(gltf, output, path === 'rotation' ? 'VEC4' : 'VEC3');
    const perTime = (path === 'rotation' ? 4 : 3) * (interpolation === 'CUBICSPLINE' ? 3 : 1);
    if (timesS.length === 0 || values.length !== perTime * timesS.length)
      throw new PathFileError(gltf.fileName, `an animation of node ${node} has not one value for each time.`);
    const known = tracks.get(node) ?? {};
    // Of several animations the first counts.
    if (!known[path]) tracks.set(node, { ...known, [path]: { timesS, values, interpolation } });
  }
}

/** Times of an animation, which increase. */
function timesAt(gltf: Gltf, index: unknown): readonly number[] {
  return once(gltf, `times of accessors[${index}]`, () => {
    const timesS = accessor(gltf, index, 'SCALAR');
    if (timesS.some((timeS, i) => i > 0 && !(timeS > timesS[i - 1])))
      throw new PathFileError(gltf.fileName, `the times in accessors[${index}] do not increase.`);
    return timesS;
  });
}

/** Readers of numbers in the component types of accessors, and what normalised integers are divided by. */
const COMPONENTS: Readonly<
  Record<number, { bytes: number; read: (view: DataView, at: number) => number; most: number }>
> = {
  5120: { bytes: 1, read: (view, at) => view.getInt8(at), most: 127 },
  5121: { bytes: 1, read: (view, at) => view.getUint8(at), most: 255 },
  5122: { bytes: 2, read: (view, at) => view.getInt16(at, true), most: 32767 },
  5123: { bytes: 2, read: (view, at) => view.getUint16(at, true), most: 65535 },
  [FLOAT]: { bytes: 4, read: (view, at) => view.getFloat32(at, true), most: 1 },
};
const SIZES: Readonly<Record<string, number>> = { SCALAR: 1, VEC3: 3, VEC4: 4 };

type AccessorType = 'SCALAR' | 'VEC3' | 'VEC4';

function accessor(gltf: Gltf, index: unknown, type: AccessorType): readonly number[] {
  return once(gltf, `accessors[${index}] as ${type}`, () => readAccessor(gltf, index, type));
}

function readAccessor(gltf: Gltf, index: unknown, type: AccessorType): readonly number[] {
  const { fileName } = gltf;
  const name = `accessors[${index}]`;
  const found = entry(gltf, 'accessors', index);
  const { bufferView, byteOffset = 0, componentType, count, normalized } = found;
  const component = COMPONENTS[componentType as number];
  if (found.type !== type || !component || !isCount(count) || found.sparse !== undefined)
    throw new PathFileError(fileName, `${name} is not a plain accessor of ${type}.`);
  const view = entry(gltf, 'bufferViews', bufferView);
  const bytes = once(gltf, `buffers[${view.buffer}]`, () => bufferBytes(gltf, view.buffer));
  const size = SIZES[type];
  const { byteStride: stride = size * component.bytes } = view;
  // Else a few bytes could be read as any number of values.
  if (!isCount(stride) || stride < size * component.bytes)
    throw new PathFileError(fileName, `the byteStride of ${name} is shorter than a value.`);
  const start = Number(view.byteOffset ?? 0) + Number(byteOffset);
  const end = start + stride * (count - 1) + size * component.bytes;
  if (!(isCount(start) && end <= bytes.length))
    throw new PathFileError(fileName, `${name} ends beyond its buffer.`);
  const data = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const divisor = normalized ? component.most : 1;
  const values = Array.from({ length: count * size }, (_, i) => {
    const at = start + stride * Math.floor(i / size) + (i % size) * component.bytes;
    return Math.max(component.read(data, at) / divisor, normalized ? -1 : -Infinity);
  });
  if (values.every(Number.isFinite)) return values;
  throw new PathFileError(fileName, `${name} has values that are no numbers.`);
}

function isCount(value: unknown): value is number {
  return Number.isSafeInteger(value) && (value as number) >= 0;
}

function bufferBytes(gltf: Gltf, index: unknown): Uint8Array {
  const { uri } = entry(gltf, 'buffers', index);
  if (uri === undefined && gltf.binary) return gltf.binary;
  const data = typeof uri === 'string' ? /^data:[^,]*;base64,(.*)$/s.exec(uri)?.[1] : undefined;
  if (data === undefined)
    throw new PathFileError(
      gltf.fileName,
      `its numbers are in another file${typeof uri === 'string' ? `, ${uri}` : ''}. Save it as .glb.`,
    );
  try {
    return Uint8Array.from(atob(data), (character) => character.charCodeAt(0));
  } catch {
    throw new PathFileError(gltf.fileName, `buffers[${index}] is no base64.`);
  }
}

/** A node's columns in the world: three axes, which may be scaled, and the place. */
type Columns = readonly [Vec3, Vec3, Vec3, Vec3];

function cameraAt(
  gltf: Gltf,
  nodes: readonly Json[],
  chain: readonly number[],
  tracks: ReadonlyMap<number, NodeTracks>,
  timeS: number,
  scene: PathScene,
): Pick<FileKey, 'pose' | 'fovDegrees'> {
  let world: Columns = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [0, 0, 0],
  ];
  for (const index of chain)
    world = product(world, localOf(gltf, nodes[index], index, tracks.get(index) ?? {}, timeS));
  const back = normalize(world[2]);
  // Scales may shear: right is at right angles to back and above again.
  const right = normalize(cross(world[1], back));
  const axes = { right, above: cross(back, right), back };
  const camera = `the camera of node ${chain[chain.length - 1]}`;
  if (![...right, ...back].every(Number.isFinite))
    throw new PathFileError(gltf.fileName, `${camera} is scaled to nothing.`);
  if (!world[3].every(isFiniteF32))
    throw new PathFileError(gltf.fileName, `${camera} is farther away than float32 can say.`);
  const drawn = (point: Vec3) => fromGltf(point, scene.isZUp);
  const pose = poseInScene(
    drawn(world[3]),
    { right: drawn(axes.right), above: drawn(axes.above), back: drawn(axes.back) },
    scene,
  );
  return { pose, fovDegrees: fovOf(gltf, nodes[chain[chain.length - 1]].camera, scene) };
}

function fovOf(gltf: Gltf, index: unknown, { fovDegrees }: PathScene): number {
  const { perspective } = entry(gltf, 'cameras', index);
  if (!isObject(perspective) || typeof perspective.yfov !== 'number') return fovDegrees;
  const { yfov, aspectRatio } = perspective;
  const degrees = shorterSideFov((yfov * 180) / Math.PI, typeof aspectRatio === 'number' ? aspectRatio : 1);
  return clamp(degrees, 1, 179);
}

function product(a: Columns, b: Columns): Columns {
  const turned = ([x, y, z]: Vec3) => add(add(scale(a[0], x), scale(a[1], y)), scale(a[2], z));
  return [turned(b[0]), turned(b[1]), turned(b[2]), add(turned(b[3]), a[3])];
}

function localOf(gltf: Gltf, node: Json, index: number, tracks: NodeTracks, timeS: number): Columns {
  if (node.matrix !== undefined && Object.keys(tracks).length === 0) {
    const m = numbers(gltf, `nodes[${index}].matrix`, node.matrix, 16);
    return [
      [m[0], m[1], m[2]],
      [m[4], m[5], m[6]],
      [m[8], m[9], m[10]],
      [m[12], m[13], m[14]],
    ];
  }
  const value = (name: keyof NodeTracks, usual: readonly number[]) => {
    const track = tracks[name];
    if (track) return valueAt(track, usual.length, timeS);
    return node[name] === undefined
      ? usual
      : numbers(gltf, `nodes[${index}].${name}`, node[name], usual.length);
  };
  const [x, y, z, w] = value('rotation', [0, 0, 0, 1]);
  const { right, above, back } = axesOf([x, y, z, w]);
  const [scaleX, scaleY, scaleZ] = value('scale', [1, 1, 1]);
  const [tx, ty, tz] = value('translation', [0, 0, 0]);
  return [scale(right, scaleX), scale(above, scaleY), scale(back, scaleZ), [tx, ty, tz]];
}

/** @param size numbers of a value: four of a rotation. */
function valueAt({ timesS, values, interpolation }: Track, size: number, timeS: number): readonly number[] {
  const at = Math.max(0, countUpTo(timesS, timeS) - 1);
  const isCubic = interpolation === 'CUBICSPLINE';
  /** Of a cubic spline, each time has the slope before, the value, and the slope after it. */
  const part = (index: number, which: 0 | 1 | 2) => {
    const start = size * (isCubic ? 3 * index + which : index);
    return values.slice(start, start + size);
  };
  const from = part(at, 1);
  const next = at + 1;
  if (interpolation === 'STEP' || next >= timesS.length || timeS <= timesS[at]) return from;
  const stepS = timesS[next] - timesS[at];
  const along = (timeS - timesS[at]) / stepS;
  const to = part(next, 1);
  if (isCubic) {
    const [slopeFrom, slopeTo] = [part(at, 2), part(next, 0)];
    return from.map((value, i) => hermite(value, stepS * slopeFrom[i], to[i], stepS * slopeTo[i], along));
  }
  return size === 4 ? slerp(from, to, along) : from.map((value, i) => value + along * (to[i] - value));
}

/** Between two unit quaternions by the shorter way round. */
/** How many of the ascending numbers are `most` or less. */
function countUpTo(ascending: readonly number[], most: number): number {
  let [low, high] = [0, ascending.length];
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (ascending[middle] <= most) low = middle + 1;
    else high = middle;
  }
  return low;
}

function slerp(from: readonly number[], to: readonly number[], along: number): readonly number[] {
  const cosine = from.reduce((sum, value, i) => sum + value * to[i], 0);
  const sign = cosine < 0 ? -1 : 1;
  const angle = Math.acos(Math.min(1, Math.abs(cosine)));
  const sine = Math.sin(angle);
  if (sine < 1e-9) return from;
  const [a, b] = [Math.sin((1 - along) * angle) / sine, (sign * Math.sin(along * angle)) / sine];
  return from.map((value, i) => a * value + b * to[i]);
}
