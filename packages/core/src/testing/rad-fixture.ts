// Writes .rad for tests.
import { deflateRawSync } from 'node:zlib';
import { toHalfBits } from '../data/layout/half.ts';
import { coefficientsPerSplat, type ShDegree } from '../data/splats/splat-set.ts';
import { seededRandom } from './seeded-random.ts';

type Bytes = Uint8Array<ArrayBuffer>;

export const RGB_RANGE = [-0.25, 1.5] as const;
export const LOG_SCALE_RANGE = [-12, 9] as const;
/** Bounds of harmonics by degree. */
export const SH_MAX = [1, 1.5, 2] as const;

export interface RadNode {
  readonly position: readonly number[];
  readonly alpha: number;
  readonly rgb: readonly number[];
  readonly logScale: readonly number[];
  /** x, y, z, w; w is not negative. */
  readonly rotation: readonly number[];
  /** By coefficient, then by channel. */
  readonly sh: readonly number[];
  readonly childCount: number;
  readonly childStart: number;
}

/**
 * Nodes of a tree, the root first, each with two or three children until there are as many; or
 * without children. Those with children may have opacities above 1.
 *
 * @param leafShare of nodes that have none although others behind them do.
 */
export function randomNodes(
  count: number,
  degree: ShDegree,
  isTree: boolean,
  seed = 1,
  leafShare = 0,
): RadNode[] {
  const random = seededRandom(seed);
  const list = (length: number, next: () => number) => Array.from({ length }, next);
  let next = 1;
  return list(count, random).map((_, node) => {
    const isLeaf = !isTree || (next - node > 8 && leafShare > 0 && random() < leafShare);
    const childCount = isLeaf ? 0 : Math.min(count - next, random() < 0.5 ? 2 : 3);
    const childStart = childCount > 0 ? next : 0;
    next += childCount;
    const turn = list(4, () => random() - 0.5);
    const length = Math.hypot(...turn) * (turn[3] < 0 ? -1 : 1);
    return {
      position: list(3, () => Math.fround(20 * random() - 10)),
      alpha: Math.fround((childCount > 0 ? 2 : 1) * random()),
      rgb: list(3, () => Math.fround(1.2 * random() - 0.1)),
      logScale: list(3, () => Math.fround(-8 * random())),
      rotation: turn.map((part) => Math.fround(part / length)),
      sh: list(coefficientsPerSplat(degree), () => Math.fround(2 * random() - 1)),
      childCount,
      childStart,
    };
  });
}

/** A tree of splats whose children lie within them, in the order of Spark: largest first, by octant. */
export function nestedNodes(count: number, chunkSize: number): RadNode[] {
  const random = seededRandom(9);
  const nodes: RadNode[] = randomNodes(count, 1, true, 4, 0.1);
  nodes[0] = { ...nodes[0], position: [0, 0, 0], logScale: [-0.7, -0.7, -0.7], rgb: [0.5, 0.5, 0.5] };
  for (const { position, logScale, rgb, childStart, childCount } of nodes)
    for (let child = childStart; child < childStart + childCount; child++)
      nodes[child] = {
        ...nodes[child],
        position: position.map((value) => Math.fround(value + 2 * Math.exp(logScale[0]) * (random() - 0.5))),
        logScale: logScale.map((value) => Math.max(-6, value - 0.4 - 0.2 * random())),
        rgb: rgb.map((value) => Math.max(0, Math.min(1, value + 0.2 * (random() - 0.5)))),
      };
  const order = [0];
  const starts = new Map<number, number>();
  const batches = [[0]];
  for (const batch of batches) {
    const end = Math.ceil((order.length + chunkSize / 8) / chunkSize) * chunkSize;
    const hasRoom = ([node]: number[]) => order.length + nodes[node].childCount <= end;
    while (batch.length > 0 && hasRoom(batch)) {
      const parent = batch.shift()!;
      const { childStart, childCount } = nodes[parent];
      if (childCount > 0) starts.set(parent, order.length);
      const children = Array.from({ length: childCount }, (_, i) => childStart + i);
      order.push(...children);
      batch.push(...children);
    }
    const octants = new Map<string, number[]>();
    for (const node of batch) {
      const octant = nodes[node].position.map((value, axis) => value > nodes[batch[0]].position[axis]).join();
      octants.set(octant, [...(octants.get(octant) ?? []), node]);
    }
    batches.push(...octants.values());
  }
  return order.map((node) => ({ ...nodes[node], childStart: starts.get(node) ?? 0 }));
}

export interface RadLayout {
  readonly degree: ShDegree;
  readonly isTree?: boolean;
  /** Other encodings than Spark's own, by property; `sh` for all of harmonics. */
  readonly encodings?: Readonly<Record<string, string>>;
  readonly chunkSize?: number;
  /** Entries of a palette that nodes share: node i has the harmonics of node i modulo so many. */
  readonly paletteSize?: number;
  /** Chunks are files of their own, with names that begin so. */
  readonly filePrefix?: string;
  readonly isPacked?: boolean;
}

interface Chunk {
  readonly json: object;
  readonly payload: Bytes;
}

export interface RadScene {
  readonly header: object;
  readonly chunks: readonly Chunk[];
}

export function radScene(nodes: readonly RadNode[], layout: RadLayout): RadScene {
  const { degree, isTree = true, chunkSize = nodes.length, paletteSize, filePrefix } = layout;
  const chunks: Chunk[] = [];
  for (let base = 0; base < nodes.length; base += chunkSize) chunks.push(chunkOf(nodes, base, layout));
  const header = {
    ...{ version: 1, type: 'gsplat', count: nodes.length, maxSh: degree },
    ...(isTree && { lodTree: true }),
    ...{ chunkSize, allChunkBytes: 0, chunks: [] as object[] },
    ...(paletteSize !== undefined && { shCodeCount: paletteSize }),
  };
  let offset = 0;
  for (const [i, { json, payload }] of chunks.entries()) {
    const bytes = chunkBytes(JSON.stringify(json), payload).length;
    const own = filePrefix !== undefined;
    header.chunks.push({
      offset: own ? 0 : offset,
      bytes,
      ...(own && { filename: `${filePrefix}${i}.radc` }),
    });
    offset += bytes;
  }
  return { header, chunks };
}

/** All of a scene in one file. */
export function radBytes(nodes: readonly RadNode[], layout: RadLayout): Bytes {
  const { header, chunks } = radScene(nodes, layout);
  return radOfTexts(
    JSON.stringify(header, null, 2),
    chunks.map(({ json, payload }) => chunkBytes(JSON.stringify(json), payload)),
  );
}

/** A scene in several files, by path. */
export function radFiles(nodes: readonly RadNode[], layout: RadLayout, folder = ''): Record<string, Bytes> {
  const filePrefix = 'scene-lod-';
  const { header, chunks } = radScene(nodes, { ...layout, filePrefix });
  const parts = chunks.map(({ json, payload }, i) => [
    `${folder}${filePrefix}${i}.radc`,
    chunkBytes(JSON.stringify(json), payload),
  ]);
  return { [`${folder}scene-lod.rad`]: radOfTexts(JSON.stringify(header), []), ...Object.fromEntries(parts) };
}

/** A scene with this text as its header. */
export function radOfTexts(header: string, chunks: readonly Bytes[]): Bytes {
  return joined([part('RAD0', header), ...chunks]);
}

/** A chunk with this text as its header. */
export function chunkBytes(json: string, payload: Bytes): Bytes {
  const length = new Uint8Array(8);
  new DataView(length.buffer).setBigUint64(0, BigInt(payload.length), true);
  return joined([part('RADC', json), length, payload]);
}

function part(magic: string, text: string): Bytes {
  const json = new TextEncoder().encode(text);
  const bytes = new Uint8Array(8 + padded(json.length));
  bytes.set(new TextEncoder().encode(magic));
  new DataView(bytes.buffer).setUint32(4, json.length, true);
  bytes.set(json, 8);
  return bytes;
}

function padded(size: number): number {
  return Math.ceil(size / 8) * 8;
}

function joined(parts: readonly Bytes[]): Bytes {
  const bytes = new Uint8Array(parts.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const each of parts) {
    bytes.set(each, at);
    at += each.length;
  }
  return bytes;
}

/** The encodings that Spark chooses for most scenes. */
const USUAL: Readonly<Record<string, string>> = {
  ...{ center: 'f32_lebytes', alpha: 'f16', rgb: 'r8_delta', scales: 'ln_0r8', orientation: 'oct88r8' },
  ...{ sh: 's8', sh_label: 'u16', child_count: 'u16', child_start: 'u32' },
};

function chunkOf(all: readonly RadNode[], base: number, layout: RadLayout): Chunk {
  const { degree, isTree = true, chunkSize = all.length, paletteSize, isPacked = true } = layout;
  const nodes = all.slice(base, base + chunkSize);
  const degrees = [1, 2, 3].slice(0, degree);
  const sh = (of: readonly RadNode[], end: string): [string, (readonly number[])[]][] =>
    degrees.map((each) => [
      `sh${each}${end}`,
      of.map((node) =>
        node.sh.slice(coefficientsPerSplat((each - 1) as ShDegree), coefficientsPerSplat(each as ShDegree)),
      ),
    ]);
  const palette = base === 0 ? sh(all.slice(0, paletteSize), '_code') : [];
  const columns: [string, (readonly number[])[]][] = [
    ['center', nodes.map(({ position }) => position)],
    ['alpha', nodes.map(({ alpha }) => [alpha])],
    ['rgb', nodes.map(({ rgb }) => rgb)],
    ['scales', nodes.map(({ logScale }) => logScale)],
    ['orientation', nodes.map(({ rotation }) => rotation)],
    ...(paletteSize === undefined
      ? sh(nodes, '')
      : [...palette, ['sh_label', nodes.map((_, i) => [(base + i) % paletteSize])] as [string, number[][]]]),
  ];
  if (isTree)
    columns.push(
      ['child_count', nodes.map(({ childCount }) => [childCount])],
      ['child_start', nodes.map(({ childStart }) => [childStart])],
    );
  const properties: object[] = [];
  const parts: Bytes[] = [];
  let offset = 0;
  for (const [property, rows] of columns) {
    const kind = /^sh\d/.test(property) ? 'sh' : property;
    const encoding = layout.encodings?.[kind] ?? USUAL[kind];
    const [min, max] = rangeOf(property);
    const raw = encoded(encoding, rows, min, max, property === 'scales');
    const bytes = isPacked ? new Uint8Array(deflateRawSync(raw)) : raw;
    properties.push({
      offset,
      bytes: bytes.length,
      property,
      encoding,
      ...(isPacked && { compression: 'gz' }),
      min,
      max,
    });
    const withPadding = new Uint8Array(padded(bytes.length));
    withPadding.set(bytes);
    parts.push(withPadding);
    offset += withPadding.length;
  }
  return {
    json: { version: 1, base, count: nodes.length, payloadBytes: offset, maxSh: degree, properties },
    payload: joined(parts),
  };
}

function rangeOf(property: string): readonly [number, number] {
  const harmonics = /^sh(\d)/.exec(property);
  if (harmonics) return [-SH_MAX[Number(harmonics[1]) - 1], SH_MAX[Number(harmonics[1]) - 1]];
  if (property === 'rgb') return RGB_RANGE;
  return property === 'scales' ? LOG_SCALE_RANGE : [0, 2];
}

/** Values of rows: all first ones, then all second ones, and so on. */
function encoded(
  encoding: string,
  rows: readonly (readonly number[])[],
  min: number,
  max: number,
  areLogs: boolean,
): Bytes {
  if (encoding === 'oct88r8') return Uint8Array.from(rows.flatMap(octahedral));
  // w follows from x, y and z.
  const width = rows[0].length === 4 ? 3 : rows[0].length;
  const values = Array.from({ length: width }, (_, k) => rows.map((row) => row[k]));
  const flat = values.flat();
  const wide = (bytes: number, set: (view: DataView, at: number, value: number) => void) => {
    const view = new DataView(new ArrayBuffer(bytes * flat.length));
    for (const [i, value] of flat.entries()) set(view, bytes * i, value);
    return new Uint8Array(view.buffer);
  };
  const unit = (value: number) => Math.max(0, Math.min(1, (value - min) / (max - min)));
  const differences = (bytes: (value: number) => number) =>
    Uint8Array.from(
      values.flatMap((column) => column.map((v, i) => bytes(v) - (i > 0 ? bytes(column[i - 1]) : 0))),
    );
  const unsigned = (value: number) => Math.round(unit(value) * 255);
  const signed = (value: number) => Math.round((value / max) * 127) & 255;
  const f32 = () =>
    wide(4, (view, at, value) => view.setFloat32(at, areLogs ? Math.exp(value) : value, true));
  const f16 = () => wide(2, (view, at, value) => view.setUint16(at, toHalfBits(value), true));
  switch (encoding) {
    case 'f32':
      return f32();
    case 'f16':
    case 'ln_f16':
      return f16();
    case 'f32_lebytes':
      return byteByByte(f32(), 4);
    case 'f16_lebytes':
      return byteByByte(f16(), 2);
    case 'r8':
      return Uint8Array.from(flat, unsigned);
    case 'r8_delta':
      return differences(unsigned);
    case 's8':
      return Uint8Array.from(flat, signed);
    case 's8_delta':
      return differences(signed);
    case 'ln_0r8':
      return Uint8Array.from(flat, (value) => (value < -30 ? 0 : 1 + Math.round(unit(value) * 254)));
    case 'u16':
      return wide(2, (view, at, value) => view.setUint16(at, value, true));
    default:
      return wide(4, (view, at, value) => view.setUint32(at, value, true));
  }
}

/** The lowest bytes of all values, then the next ones. */
function byteByByte(bytes: Bytes, valueBytes: number): Bytes {
  const count = bytes.length / valueBytes;
  return bytes.map((_, i) => bytes[(i % count) * valueBytes + Math.floor(i / count)]);
}

/** The axis of a rotation on an octahedron that is folded into a square, and its angle. */
function octahedral([x, y, z, w]: readonly number[]): number[] {
  const sum = Math.abs(x) + Math.abs(y) + Math.abs(z);
  const sign = (value: number) => (value < 0 ? -1 : 1);
  const [u, v] = [x / sum, y / sum];
  const folded = z < 0 ? [(1 - Math.abs(v)) * sign(u), (1 - Math.abs(u)) * sign(v)] : [u, v];
  const turned = (2 * Math.acos(w)) / Math.PI;
  return [...folded.map((value) => Math.round((value * 0.5 + 0.5) * 255)), Math.round(turned * 255)];
}
