import { unzigzag, zigzag } from '../bricks/planes.ts';

// Integers of a frame as bytes: a column has a byte of flags, then planes of one byte per splat, the
// lowest byte first. Planes that are zero throughout are left out, and so a column of zeros is a byte.

/** Integers of a property, one per splat; null: all are 0. */
export type FrameColumn = Int32Array | null;

/** Lower bits of the flags: planes of a column. */
const MOST_PLANES = 4;
const PLANES_MASK = 7;
/** Flag: values are differences from the splat before, modulo 2³². */
const IS_DIFFERENCE = 8;

/** The columns of a frame as bytes, to be compressed. */
export function packColumns(columns: readonly FrameColumn[], splatCount: number): Uint8Array<ArrayBuffer> {
  const coded = columns.map((column) => column && codedColumn(column));
  const planes = coded.map((column) => (column ? planesOf(column.values) : 0));
  const bytes = new Uint8Array(columns.length + splatCount * planes.reduce((sum, each) => sum + each, 0));
  let at = 0;
  for (const [i, column] of coded.entries()) {
    bytes[at++] = planes[i] | (column?.isDifference && planes[i] > 0 ? IS_DIFFERENCE : 0);
    for (let plane = 0; plane < planes[i]; plane++, at += splatCount)
      for (let k = 0; k < splatCount; k++) bytes[at + k] = column!.values[k] >>> (8 * plane);
  }
  return bytes;
}

/** Zigzag codes of values, or of differences if their codes are shorter. */
function codedColumn(column: Int32Array): {
  readonly values: Uint32Array;
  readonly isDifference: boolean;
} {
  const own = new Uint32Array(column.length);
  const differences = new Uint32Array(column.length);
  let [ownBits, differenceBits, before] = [0, 0, 0];
  for (let i = 0; i < column.length; i++) {
    const value = column[i];
    own[i] = zigzag(value);
    differences[i] = zigzag((value - before) | 0);
    ownBits += 32 - Math.clz32(own[i]);
    differenceBits += 32 - Math.clz32(differences[i]);
    before = value;
  }
  const isDifference = differenceBits < ownBits;
  return { values: isDifference ? differences : own, isDifference };
}

function planesOf(values: Uint32Array): number {
  let all = 0;
  for (let i = 0; i < values.length; i++) all |= values[i];
  return Math.ceil((32 - Math.clz32(all)) / 8);
}

/** The columns that `packColumns` has packed; null if the bytes are no such columns. */
export function unpackColumns(
  bytes: Uint8Array,
  columnCount: number,
  splatCount: number,
): FrameColumn[] | null {
  const columns: FrameColumn[] = [];
  let at = 0;
  for (let i = 0; i < columnCount; i++) {
    const flags = bytes[at++];
    const planes = flags & PLANES_MASK;
    if (flags === undefined || flags >= 2 * IS_DIFFERENCE || planes > MOST_PLANES) return null;
    if (at + planes * splatCount > bytes.length) return null;
    columns.push(
      planes === 0 ? null : columnOf(bytes, at, planes, splatCount, (flags & IS_DIFFERENCE) !== 0),
    );
    at += planes * splatCount;
  }
  return at === bytes.length ? columns : null;
}

function columnOf(
  bytes: Uint8Array,
  from: number,
  planes: number,
  splatCount: number,
  isDifference: boolean,
): Int32Array {
  const column = new Int32Array(splatCount);
  let before = 0;
  for (let k = 0; k < splatCount; k++) {
    let code = 0;
    for (let plane = planes; plane-- > 0; ) code = (code << 8) | bytes[from + plane * splatCount + k];
    const value = unzigzag(code);
    before = isDifference ? (before + value) | 0 : value;
    column[k] = before;
  }
  return column;
}
