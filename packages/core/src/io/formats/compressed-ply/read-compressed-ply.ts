import { SplatFileError, type SplatFileErrorCode } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { originOfSamples } from '../../../data/packing/origin.ts';
import type { ByteValues } from '../../../data/packing/row-layout.ts';
import { colorDcOf, logitOf, tableOfBytes } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import type { ShDegree } from '../../../data/splats/splat-set.ts';
import { readExactly } from '../../sources/read-all.ts';
import {
  clip,
  type PlyElement,
  type PlyHeader,
  type PlyType,
  readPlyHeader,
  shPropertiesOf,
  TYPE_BYTES,
} from '../ply/ply-header.ts';
import type { ReadFormat, SplatInput } from '../read-format.ts';
import { ArrivingRows, type RowSource } from '../rows/arriving-rows.ts';
import { type ByteHarmonics, floatRows } from '../rows/byte-harmonics.ts';
import { deliverRows, rowLength } from '../rows/decoded-rows.ts';
import { FLAT_LOG_SCALE } from '../rows/flat-scale.ts';
import { ReadProgress } from '../rows/progress.ts';
import { takesCount } from '../rows/row-sink.ts';
import { checkCount } from '../rows/splat-counts.ts';
import { BOUNDED, boundsNames, CHUNK_ROWS, PACKED } from './chunk-layout.ts';

/** Geometry bounds of a chunk: least values, then greatest. */
const GEOMETRY_BOUNDS = boundsNames([...BOUNDED.position, ...BOUNDED.logScale]);
const COLOR_BOUNDS = boundsNames(BOUNDED.color);
/** Indices of log scale bounds in `GEOMETRY_BOUNDS`. */
const SCALE_BOUNDS = new Set([3, 4, 5, 9, 10, 11]);

const LOGITS = tableOfBytes(logitOf);

/**
 * Writers divide −4 … 4 into 256 steps and store the step's index; its midpoint has the least average
 * error. Values out of range are clamped to the outermost steps, which stand for −4 and 4.
 */
const SH_VALUES: ByteValues = { least: -4, most: 4, scale: 1 / 32, offset: 1 / 64 - 4 };

/** Location of an element's rows. */
interface Rows {
  /** Byte offset of the first row. */
  readonly start: number;
  readonly strideBytes: number;
  /** Byte offset within a row, per property that is read. */
  readonly offsets: readonly number[];
}

interface Layout {
  /** Number of splats. */
  readonly count: number;
  readonly shDegree: ShDegree;
  /** See `FileFacts`. */
  readonly note: string | undefined;
  /** Whether chunks have bounds of colours. Older files lack them: 0 is black and 1 is white. */
  readonly hasColorBounds: boolean;
  readonly chunks: Rows;
  readonly vertices: Rows;
  readonly harmonics: Rows | undefined;
  /** Bytes of the body, up to the last that is needed. */
  readonly totalBytes: number;
}

/**
 * Reads a compressed PLY of either byte order. Elements and properties:
 *
 * - `chunk`: the bounds of 256 splats
 * - `vertex.packed_position` and `vertex.packed_scale`: 11, 10 and 11 bits, from the chunk's least
 *   to its greatest value
 * - `vertex.packed_rotation`: 2 bits for the index of the largest of w, x, y, z, and 10 bits for
 *   each of the others in order
 * - `vertex.packed_color`: one byte each for r, g, b, opacity
 * - `sh`, optional: one byte per f_rest
 *
 * An opacity of 0 or 255 is a logit of ±Infinity.
 *
 * Rejects with `SplatFileError`: 'damaged' if the numbers of rows contradict each other;
 * 'bad-header', 'bad-property', 'truncated', 'too-large', 'empty'.
 */
export const read: ReadFormat = async (input, options, rowsTo) => {
  const { reader, name: file } = input;
  const header = await readPlyHeader(reader, file);
  const layout = layoutOf(header, file);
  const { count, shDegree, totalBytes } = layout;
  checkCount(count, file, options.maxSplats, { element: 'vertex' });
  const { vertices, harmonics } = layout;
  const isPassed = rowsTo !== undefined && takesCount(rowsTo.files, count);
  const last = isPassed || options.onPiece ? arrivingRows(layout, input) : null;
  const progress = new ReadProgress(input, options.onProgress);
  const firstBytes = last ? last.rows.start : totalBytes;
  const bytes = await readExactly(input, firstBytes, `its ${count} splats`, progress.arrived);
  const sourceOf = (rows: Rows | undefined) =>
    last && rows === last.rows ? last.source : { bytes, start: rows?.start ?? 0 };
  const isLittleEndian = header.format !== 'binary_big_endian';
  const origin = originOf(bytes, layout, isLittleEndian);
  const decodeGeometry = geometryDecoder(bytes, sourceOf(vertices), layout, isLittleEndian, origin);
  const byteHarmonics: ByteHarmonics | undefined = harmonics && {
    source: sourceOf(harmonics),
    strideBytes: harmonics.strideBytes,
    offsets: harmonics.offsets,
    values: SH_VALUES,
    decodeGeometry,
  };
  const decode = byteHarmonics
    ? floatRows(byteHarmonics)
    : (rows: Float32Array, rowCount: number) => decodeGeometry(rows, rowCount, rowLength(0));
  const { isAntialiased, format: variant, writer } = header;
  const notes = layout.note === undefined ? undefined : [layout.note];
  const fileFacts = { format: 'compressed-ply', variant, writer, notes };
  const rows = {
    ...{ count, shDegree, isAntialiased, fileFacts, arrive: last?.source.arrive, decode, byteHarmonics },
    // Positions near 0 keep the file's coordinates.
    ...(origin.some((value) => value !== 0) && { origin }),
  };
  return deliverRows(rows, input, options, rowsTo, progress);
};

/**
 * The rows at the end of the file, most of its bytes, are decoded while they arrive: harmonics, or
 * vertices if there are none. Null if others are last, or if the file's size is uncertain, because
 * memory for all splats is allocated first.
 */
function arrivingRows(
  { count, chunks, vertices, harmonics, totalBytes }: Layout,
  input: SplatInput,
): { readonly rows: Rows; readonly source: ArrivingRows } | null {
  const { reader, totalBytes: fileBytes = 0, totalBytesCertain } = input;
  const isThere = totalBytesCertain && fileBytes - reader.byteOffset >= totalBytes;
  const rows = harmonics ?? vertices;
  const isLast = [chunks, vertices].every((each) => each === rows || each.start < rows.start);
  if (!isLast || !isThere) return null;
  const place = harmonics ? `the harmonics of its ${count} splats` : `its ${count} splats`;
  return { rows, source: new ArrivingRows(input, rows.strideBytes, () => `within ${place}`) };
}

/** Locates the needed parts of the body; throws if one is missing. */
function layoutOf({ format, elements }: PlyHeader, file: string): Layout {
  const fail = (code: SplatFileErrorCode, message: string, element?: string): never => {
    throw new SplatFileError(code, file, `${message}.`, { element });
  };
  if (format === 'ascii') fail('bad-header', 'it is a compressed PLY in text; such files are binary');
  const found = (name: string) => elements.find((element) => element.name === name);
  const chunk = found('chunk') ?? fail('bad-header', 'it is a compressed PLY without an element chunk');
  const vertex = found('vertex') ?? fail('bad-header', 'it is a compressed PLY without an element vertex');
  const sh = found('sh');
  const { count } = vertex;
  if (chunk.count < Math.ceil(count / CHUNK_ROWS)) {
    const message = `${count} splats in chunks of ${CHUNK_ROWS} need more than ${chunk.count} chunks`;
    fail('damaged', message, 'chunk');
  }
  if (sh && sh.count !== count) {
    fail('damaged', `it has ${count} splats, but harmonics of ${sh.count}`, 'sh');
  }
  const shProperties = sh && shPropertiesOf(sh, file);
  const hasColorBounds = chunk.properties.some(({ name }) => COLOR_BOUNDS.includes(name));
  const bounds = hasColorBounds ? [...GEOMETRY_BOUNDS, ...COLOR_BOUNDS] : GEOMETRY_BOUNDS;
  const rowsOf = (element: PlyElement, names: readonly string[], type: PlyType): Rows => ({
    start: elements.slice(0, elements.indexOf(element)).reduce((sum, each) => sum + bytesOf(each, file), 0),
    strideBytes: strideOf(element, file),
    offsets: offsetsOf(element, names, type, file),
  });
  const needed = [chunk, vertex, ...(sh ? [sh] : [])];
  const last = elements.findLastIndex((element) => needed.includes(element));
  return {
    count,
    shDegree: shProperties?.degree ?? 0,
    note: shProperties?.note,
    hasColorBounds,
    chunks: rowsOf(chunk, bounds, 'float32'),
    vertices: rowsOf(vertex, PACKED, 'uint32'),
    harmonics: sh && rowsOf(sh, shProperties?.names ?? [], 'uint8'),
    totalBytes: elements.slice(0, last + 1).reduce((sum, each) => sum + bytesOf(each, file), 0),
  };
}

function bytesOf(element: PlyElement, file: string): number {
  return element.count * strideOf(element, file);
}

function strideOf({ name: element, properties }: PlyElement, file: string): number {
  const list = properties.find(({ countType }) => countType !== undefined);
  if (list) {
    const message = `${clip(list.name)} is a list; a compressed PLY has none.`;
    throw new SplatFileError('bad-property', file, message, {
      element: clip(element),
      property: clip(list.name),
    });
  }
  return properties.reduce((sum, { type }) => sum + TYPE_BYTES[type], 0);
}

/** Byte offsets within a row of properties, all of which must have `type`. */
function offsetsOf(
  { name: element, properties }: PlyElement,
  names: readonly string[],
  type: PlyType,
  file: string,
): number[] {
  const fail = (property: string, message: string): never => {
    throw new SplatFileError('bad-property', file, `${property} ${message}.`, { element, property });
  };
  const needed = new Set(names);
  const offsets = new Map<string, number>();
  let offset = 0;
  for (const property of properties) {
    if (needed.has(property.name)) {
      if (offsets.has(property.name)) fail(property.name, 'is declared twice');
      if (property.type !== type) fail(property.name, `is of type ${property.type}; it must be ${type}`);
      offsets.set(property.name, offset);
    }
    offset += TYPE_BYTES[property.type];
  }
  return names.map((name) => offsets.get(name) ?? fail(name, 'is missing'));
}

/** Centre of the chunks' bounding box if it lies far from 0; else 0, 0, 0. */
function originOf(bytes: Uint8Array<ArrayBuffer>, { count, chunks }: Layout, isLittleEndian: boolean): Vec3 {
  const body = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const corners = new Float64Array(6 * Math.ceil(count / CHUNK_ROWS));
  for (let at = 0; at < corners.length; at++) {
    const [corner, axis] = [Math.floor(at / 3), at % 3];
    const start = chunks.start + (corner >> 1) * chunks.strideBytes;
    // Bounds begin with the least values of positions and log scales, then the greatest.
    corners[at] = body.getFloat32(start + chunks.offsets[6 * (corner & 1) + axis], isLittleEndian);
  }
  return originOfSamples(corners);
}

/** Writes all but the harmonics of the next rows, which have `length` words each. */
type DecodeGeometry = (rows: Float32Array, rowCount: number, length: number) => void;

/**
 * @param bytes where the chunks are.
 * @param source where the next vertex is.
 * @param origin origin to which row positions are relative.
 */
function geometryDecoder(
  bytes: Uint8Array<ArrayBuffer>,
  source: RowSource,
  { hasColorBounds, chunks, vertices }: Layout,
  isLittleEndian: boolean,
  origin: Vec3,
): DecodeGeometry {
  const body = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const [positionAt, rotationAt, scaleAt, colorAt] = vertices.offsets;
  /** Least value, and the range to the greatest, of x, y, z, three scales, r, g, b. */
  const least = new Float64Array(9);
  const extent = new Float64Array(9).fill(1);
  const takeBounds = (chunk: number) => {
    const start = chunks.start + chunk * chunks.strideBytes;
    const bound = (i: number) => {
      const value = body.getFloat32(start + chunks.offsets[i], isLittleEndian);
      // Writers that do not clamp log scales store the −∞ of flat splats.
      return value === Number.NEGATIVE_INFINITY && SCALE_BOUNDS.has(i) ? FLAT_LOG_SCALE : value;
    };
    for (let i = 0; i < (hasColorBounds ? 9 : 6); i++) {
      const [minAt, maxAt] = i < 6 ? [i, i + 6] : [i + 6, i + 9];
      least[i] = bound(minAt);
      extent[i] = bound(maxAt) - least[i];
    }
    for (let axis = 0; axis < 3; axis++) least[axis] -= origin[axis];
  };
  let row = 0;
  return (rows, rowCount, length) => {
    const arrived = new DataView(source.bytes.buffer, source.bytes.byteOffset, source.bytes.length);
    for (let at = 0; at < rowCount * length; at += length, row++, source.start += vertices.strideBytes) {
      if (row % CHUNK_ROWS === 0) takeBounds(row / CHUNK_ROWS);
      const { start } = source;
      const position = arrived.getUint32(start + positionAt, isLittleEndian);
      const scale = arrived.getUint32(start + scaleAt, isLittleEndian);
      const color = arrived.getUint32(start + colorAt, isLittleEndian);
      rows[at + ROW_SLOT.position] = least[0] + extent[0] * ((position >>> 21) / 2047);
      rows[at + ROW_SLOT.position + 1] = least[1] + extent[1] * (((position >>> 11) & 1023) / 1023);
      rows[at + ROW_SLOT.position + 2] = least[2] + extent[2] * ((position & 2047) / 2047);
      rows[at + ROW_SLOT.logScale] = least[3] + extent[3] * ((scale >>> 21) / 2047);
      rows[at + ROW_SLOT.logScale + 1] = least[4] + extent[4] * (((scale >>> 11) & 1023) / 1023);
      rows[at + ROW_SLOT.logScale + 2] = least[5] + extent[5] * ((scale & 2047) / 2047);
      unpackRotation(arrived.getUint32(start + rotationAt, isLittleEndian), rows, at + ROW_SLOT.rotation);
      rows[at + ROW_SLOT.opacity] = LOGITS[color & 255];
      rows[at + ROW_SLOT.colorDc] = colorDcOf(least[6] + extent[6] * ((color >>> 24) / 255));
      rows[at + ROW_SLOT.colorDc + 1] = colorDcOf(least[7] + extent[7] * (((color >>> 16) & 255) / 255));
      rows[at + ROW_SLOT.colorDc + 2] = colorDcOf(least[8] + extent[8] * (((color >>> 8) & 255) / 255));
    }
  };
}

/** The three stored components are at most √½; the largest follows from unit length. */
function unpackRotation(packed: number, rows: Float32Array, at: number): void {
  const a = (((packed >>> 20) & 1023) / 1023 - 0.5) * Math.SQRT2;
  const b = (((packed >>> 10) & 1023) / 1023 - 0.5) * Math.SQRT2;
  const c = ((packed & 1023) / 1023 - 0.5) * Math.SQRT2;
  const largest = packed >>> 30;
  rows[at] = a;
  rows[at + 1] = largest < 1 ? a : b;
  rows[at + 2] = largest < 2 ? b : c;
  rows[at + 3] = c;
  rows[at + largest] = Math.sqrt(Math.max(0, 1 - a * a - b * b - c * c));
}
