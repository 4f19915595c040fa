import { SplatFileError } from '../../../data/errors.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { fromHalfBits } from '../../../data/layout/half.ts';
import { type RowLayout, rowsWithin } from '../../../data/packing/row-layout.ts';
import type { ShDegree } from '../../../data/splats/splat-set.ts';
import type { ByteReader } from '../../sources/byte-reader.ts';
import type { ReadProgress } from '../rows/progress.ts';
import type { RowSink } from '../rows/row-sink.ts';
import type { SplatSetBuilder } from '../rows/splat-set-builder.ts';
import { clip, type PlyBody, type PlyElement, type PlyType, TYPE_BYTES } from './ply-header.ts';

type ReadScalar = (view: DataView, offset: number, littleEndian: boolean) => number;

const READ_SCALAR: Readonly<Record<PlyType, ReadScalar>> = {
  int8: (view, offset) => view.getInt8(offset),
  uint8: (view, offset) => view.getUint8(offset),
  int16: (view, offset, littleEndian) => view.getInt16(offset, littleEndian),
  uint16: (view, offset, littleEndian) => view.getUint16(offset, littleEndian),
  int32: (view, offset, littleEndian) => view.getInt32(offset, littleEndian),
  uint32: (view, offset, littleEndian) => view.getUint32(offset, littleEndian),
  float16: (view, offset, littleEndian) => fromHalfBits(view.getUint16(offset, littleEndian)),
  float32: (view, offset, littleEndian) => view.getFloat32(offset, littleEndian),
  float64: (view, offset, littleEndian) => view.getFloat64(offset, littleEndian),
};

/** Target arrival time of a piece of rows, so that partial scenes appear steadily. */
const PIECE_MS = 500;
/** The first piece is smaller by this factor, so that it appears early on slow connections. */
const FIRST_PART = 1 / 16;
/** Largest growth between consecutive pieces, so that a slowing transfer does not stall in a huge one. */
const MOST_GROWTH = 2;
/** Rows with lists between two progress reports. */
const ROWS_PER_REPORT = 1024;

/**
 * Layout of the splats' rows; null unless all rows have one length and all needed properties are
 * float32.
 */
export function rowLayoutOf(
  { header, vertexIndex, slots }: PlyBody,
  shDegree: ShDegree,
  pieceBytes: number,
): RowLayout | null {
  const vertex = header.elements[vertexIndex];
  const strideBytes = rowBytes(vertex);
  const isFloat = vertex.properties.every(({ type }, i) => slots[i] < 0 || type === 'float32');
  if (header.format === 'ascii' || strideBytes === undefined || !isFloat) return null;
  const offsets: number[] = [];
  let offset = 0;
  for (const [i, { type }] of vertex.properties.entries()) {
    if (slots[i] >= 0) offsets[slots[i]] = offset;
    offset += TYPE_BYTES[type];
  }
  const isBigEndian = header.format === 'binary_big_endian';
  const pieceRows = rowsWithin(pieceBytes, strideBytes);
  return { count: vertex.count, strideBytes, pieceRows, offsets, isBigEndian, shDegree };
}

/** Passes raw rows of splats of a binary body to a sink. */
export async function passRows(
  reader: ByteReader,
  body: PlyBody,
  layout: RowLayout,
  sink: RowSink,
  progress: ReadProgress,
): Promise<void> {
  const { count, strideBytes, pieceRows } = layout;
  const vertex = body.header.elements[body.vertexIndex];
  await skipTo(reader, body, progress);
  let atOnce = wholeChunks(FIRST_PART * pieceRows, pieceRows);
  for (let row = 0, rowCount = 0; row < count; row += rowCount) {
    rowCount = Math.min(atOnce, count - row);
    const memory = await sink.memory();
    const beganMs = performance.now();
    const expectedBytes = reader.byteOffset + (count - row) * strideBytes;
    const onPart = () => progress.report(row);
    const rows = memory.subarray(0, rowCount * strideBytes);
    const filled = await reader.readInto(rows, sink.mayDetach, onPart);
    if (!filled) throw truncatedError(reader, body, vertex, row, expectedBytes);
    sink.take(rowCount, filled);
    const elapsedMs = performance.now() - beganMs;
    atOnce = wholeChunks(rowCount * Math.min(MOST_GROWTH, PIECE_MS / elapsedMs), pieceRows);
  }
}

/** @returns about `rows` rows, rounded to whole chunks: at least one chunk, at most a piece. */
function wholeChunks(rows: number, pieceRows: number): number {
  return Math.min(pieceRows, CHUNK_SPLATS * Math.max(1, Math.floor(rows / CHUNK_SPLATS)));
}

/** Reads a binary body up to the last splat. Splats go to `builder`. */
export async function readBinaryRows(
  reader: ByteReader,
  body: PlyBody,
  builder: SplatSetBuilder,
  progress: ReadProgress,
): Promise<void> {
  await skipTo(reader, body, progress);
  const vertex = body.header.elements[body.vertexIndex];
  const stride = rowBytes(vertex);
  if (stride === undefined) await readListRows(reader, body, vertex, builder, progress);
  else await readFixedRows(reader, body, stride, builder, progress);
}

/** Skips the rows of elements before the splats. */
async function skipTo(reader: ByteReader, body: PlyBody, progress: ReadProgress): Promise<void> {
  for (const element of body.header.elements.slice(0, body.vertexIndex)) {
    const stride = rowBytes(element);
    if (stride === undefined) await readListRows(reader, body, element, undefined, progress);
    else if (!(await reader.skip(element.count * stride))) throw truncatedError(reader, body, element);
  }
}

/** Bytes per row; undefined if lists make the length vary. */
export function rowBytes(element: PlyElement): number | undefined {
  if (element.properties.some(({ countType }) => countType !== undefined)) return undefined;
  return element.properties.reduce((sum, { type }) => sum + TYPE_BYTES[type], 0);
}

async function readFixedRows(
  reader: ByteReader,
  body: PlyBody,
  stride: number,
  builder: SplatSetBuilder,
  progress: ReadProgress,
): Promise<void> {
  const vertex = body.header.elements[body.vertexIndex];
  const decodeRow = rowDecoder(body, vertex, builder.row);
  for (let row = 0; row < vertex.count; ) {
    if (!(await reader.fill(stride))) {
      const expectedBytes = reader.byteOffset + (vertex.count - row) * stride;
      throw truncatedError(reader, body, vertex, row, expectedBytes);
    }
    const rowCount = Math.min(vertex.count - row, Math.floor(reader.available / stride));
    for (let i = 0; i < rowCount; i++) {
      decodeRow(reader.view, reader.start + i * stride);
      builder.push(row + i);
    }
    reader.advance(rowCount * stride);
    row += rowCount;
    progress.report(builder.count);
    await builder.handOn();
  }
}

/** Returns a function that decodes the needed values of the row at `start` into `target`. */
function rowDecoder(
  body: PlyBody,
  vertex: PlyElement,
  target: Float64Array,
): (view: DataView, start: number) => void {
  const littleEndian = body.header.format === 'binary_little_endian';
  const fields: { slot: number; offset: number; type: PlyType }[] = [];
  let offset = 0;
  vertex.properties.forEach(({ type }, i) => {
    if (body.slots[i] >= 0) fields.push({ slot: body.slots[i], offset, type });
    offset += TYPE_BYTES[type];
  });
  const slots = Int32Array.from(fields, (field) => field.slot);
  const offsets = Int32Array.from(fields, (field) => field.offset);
  if (fields.every(({ type }) => type === 'float32')) {
    return (view, start) => {
      for (let i = 0; i < slots.length; i++)
        target[slots[i]] = view.getFloat32(start + offsets[i], littleEndian);
    };
  }
  const readers = fields.map(({ type }) => READ_SCALAR[type]);
  return (view, start) => {
    for (let i = 0; i < slots.length; i++)
      target[slots[i]] = readers[i](view, start + offsets[i], littleEndian);
  };
}

/** Reads rows value by value. Splats go to `builder`; without a builder, rows are skipped. */
async function readListRows(
  reader: ByteReader,
  body: PlyBody,
  element: PlyElement,
  builder: SplatSetBuilder | undefined,
  progress: ReadProgress,
): Promise<void> {
  const littleEndian = body.header.format === 'binary_little_endian';
  for (let row = 0; row < element.count; row++) {
    for (let i = 0; i < element.properties.length; i++) {
      const { name, type, countType } = element.properties[i];
      const size = TYPE_BYTES[countType ?? type];
      if (reader.available < size && !(await reader.fill(size)))
        throw truncatedError(reader, body, element, row);
      const value = READ_SCALAR[countType ?? type](reader.view, reader.start, littleEndian);
      if (countType === undefined) {
        reader.advance(size);
        if (builder && body.slots[i] >= 0) builder.row[body.slots[i]] = value;
        continue;
      }
      if (value < 0) {
        const place = { element: element.name, row, property: name, byte: reader.byteOffset };
        throw new SplatFileError(
          'bad-value',
          body.file,
          `a list of ${value} items; the file is damaged.`,
          place,
        );
      }
      reader.advance(size);
      // Awaited only if bytes are missing: an await per list would dominate the time.
      const itemBytes = value * TYPE_BYTES[type];
      if (reader.available >= itemBytes) reader.advance(itemBytes);
      else if (!(await reader.skip(itemBytes))) throw truncatedError(reader, body, element, row);
    }
    builder?.push(row);
    if (row % ROWS_PER_REPORT !== 0) continue;
    progress.report(builder?.count ?? 0);
    await builder?.handOn();
  }
}

function truncatedError(
  reader: ByteReader,
  body: PlyBody,
  element: PlyElement,
  row?: number,
  expectedBytes?: number,
): SplatFileError {
  const byte = reader.byteOffset + reader.available;
  const message = `the file ends before its ${element.count} rows of ${clip(element.name)} do. Download or export it again.`;
  const place = { element: element.name, row, byte, expectedBytes };
  return new SplatFileError('truncated', body.file, message, place);
}
