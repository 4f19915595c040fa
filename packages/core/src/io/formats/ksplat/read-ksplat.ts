import { SplatFileError, type SplatFileErrorCode } from '../../../data/errors.ts';
import { fromHalfBits } from '../../../data/layout/half.ts';
import { colorDcOf, logitOf, tableOfBytes } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import { readExactly } from '../../sources/read-all.ts';
import type { ReadFormat } from '../read-format.ts';
import { deliverRows, rowLength } from '../rows/decoded-rows.ts';
import { logScaleOf } from '../rows/flat-scale.ts';
import { ReadProgress } from '../rows/progress.ts';
import { checkCount } from '../rows/splat-counts.ts';

const HEADER_BYTES = 4096;
const SECTION_HEADER_BYTES = 1024;
/** Bytes per bucket: its centre, 3 × f32. */
const BUCKET_BYTES = 12;

/** Bytes of a coordinate, scale or rotation component, and of a coefficient, by compression level. */
const NUMBER_BYTES = [4, 2, 2];
const COEFFICIENT_BYTES = [4, 2, 1];
/** Default half range of bucket positions, by compression level: stored integers go up to twice this. */
const POSITION_RANGES = [1, 32767, 32767];
/** Default range of level 2 coefficients, −1.5 to 1.5, if the header has 0. */
const SH_RANGE = 1.5;

/** Row slot of each coefficient, after the splat's other values; the file has degree, then channel. */
const SH_SLOTS = Uint8Array.from({ length: 24 }, (_, i) => {
  const [first, perChannel] = i < 9 ? [0, 3] : [9, 5];
  const channel = Math.floor((i - first) / perChannel);
  return first + 3 * ((i - first) % perChannel) + channel;
});

const COLORS = tableOfBytes(colorDcOf);
const LOGITS = tableOfBytes(logitOf);

/** Splats with a common layout. */
interface Section {
  readonly count: number;
  readonly shDegree: ShDegree;
  readonly rowBytes: number;
  /**
   * Byte offsets relative to the end of all headers: lengths of partial buckets, then centres, then
   * rows.
   */
  readonly lengthsStart: number;
  readonly centersStart: number;
  readonly rowsStart: number;
  readonly bucketSize: number;
  readonly fullBuckets: number;
  readonly partialBuckets: number;
  /** Stored integer of a bucket's centre, and the length of a step. */
  readonly positionRange: number;
  readonly positionStep: number;
}

interface Layout {
  readonly level: number;
  readonly count: number;
  readonly shDegree: ShDegree;
  readonly sections: readonly Section[];
  /** Coefficients of the bytes 0 and 255 in level 2. */
  readonly shLeast: number;
  readonly shGreatest: number;
  /** Bytes after all headers. */
  readonly bodyBytes: number;
}

/**
 * Reads a `.ksplat` of version 0.1 or above, little-endian: a header of 4096 bytes, a header of
 * 1024 bytes per section, and the sections. A section has the lengths of its partial buckets, the
 * centres of all its buckets, and rows.
 *
 * A row has position, linear scale and rotation w x y z. One byte each for red, green, blue and
 * opacity follows, then harmonics of degree 1 and 2 by channel. Level 0 uses f32. Levels 1 and 2
 * use float16, but 16-bit integers relative to a bucket's centre for positions. Level 2 uses one
 * byte per coefficient.
 *
 * An opacity of 0 or 255 is a logit of ±Infinity. A scale of 0 is read as flat (`logScaleOf`),
 * because float16 rounds very thin splats to 0. Rows with a negative scale, or with a value that is
 * not finite, are dropped.
 *
 * Rejects with `SplatFileError`: 'damaged' if numbers of splats or buckets contradict each other;
 * 'bad-header', 'truncated', 'too-large', 'empty'.
 */
export const read: ReadFormat = async (input, options, rowsTo) => {
  const { name: file } = input;
  const header = viewOf(await readExactly(input, HEADER_BYTES, 'the header'));
  const version = [header.getUint8(0), header.getUint8(1)];
  if (version[0] !== 0 || version[1] < 1) {
    const message = `it is a .ksplat of version ${version.join('.')}; versions 0.1 and above, below 1, are read.`;
    throw new SplatFileError('bad-header', file, message, { byte: 0 });
  }
  const sectionCount = header.getUint32(4, true);
  checkCount(header.getUint32(16, true), file, options.maxSplats, { byte: 16 });
  const sectionBytes = SECTION_HEADER_BYTES * sectionCount;
  const sectionHeaders = await readExactly(
    input,
    sectionBytes,
    `the headers of its ${sectionCount} sections`,
  );
  const layout = layoutOf(header, viewOf(sectionHeaders), file);
  const { count, shDegree } = layout;
  const progress = new ReadProgress(input, options.onProgress);
  const body = viewOf(await readExactly(input, layout.bodyBytes, `its ${count} splats`, progress.arrived));
  for (const section of layout.level > 0 ? layout.sections : []) checkBuckets(section, body, file);
  const fileFacts = { format: 'ksplat', variant: `${version.join('.')}, level ${layout.level}` };
  return deliverRows(
    { count, shDegree, fileFacts, decode: rowDecoder(body, layout) },
    input,
    options,
    rowsTo,
    progress,
  );
};

function viewOf(bytes: Uint8Array): DataView {
  return new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
}

function layoutOf(header: DataView, sectionHeaders: DataView, file: string): Layout {
  const fail = (code: SplatFileErrorCode, message: string, byte: number): never => {
    throw new SplatFileError(code, file, `${message}.`, { byte });
  };
  const count = header.getUint32(16, true);
  const level = header.getUint16(20, true);
  if (level >= NUMBER_BYTES.length)
    fail('bad-header', `compression level ${level} is not one of 0, 1, 2`, 20);
  const sections: Section[] = [];
  let start = 0;
  for (let at = 0; at < sectionHeaders.byteLength; at += SECTION_HEADER_BYTES) {
    const place = HEADER_BYTES + at;
    const word = (offset: number) => sectionHeaders.getUint32(at + offset, true);
    const [splats, roomFor, bucketSize, buckets] = [word(0), word(4), word(8), word(12)];
    const bucketBytes = sectionHeaders.getUint16(at + 20, true);
    const [fullBuckets, partialBuckets] = [word(32), word(36)];
    const degree = sectionHeaders.getUint16(at + 40, true);
    const name = `section ${sections.length}`;
    if (degree > 2)
      fail('bad-header', `${name} has harmonics of degree ${degree}; there are 0, 1 and 2`, place + 40);
    if (splats > roomFor) fail('damaged', `${name} has ${splats} splats, but room for ${roomFor}`, place);
    if (level > 0 && splats > 0 && (fullBuckets + partialBuckets > buckets || bucketBytes !== BUCKET_BYTES)) {
      const found = `${fullBuckets} full and ${partialBuckets} other buckets among ${buckets} of ${bucketBytes} bytes`;
      fail('damaged', `${name} has ${found}; each has ${BUCKET_BYTES}`, place + 12);
    }
    const shDegree = degree as ShDegree;
    const positionRange = word(24) || POSITION_RANGES[level];
    const centersStart = start + 4 * partialBuckets;
    const rowsStart = centersStart + buckets * bucketBytes;
    const rowBytes = 10 * NUMBER_BYTES[level] + 4 + coefficientsPerSplat(shDegree) * COEFFICIENT_BYTES[level];
    sections.push({
      count: splats,
      shDegree,
      rowBytes,
      lengthsStart: start,
      centersStart,
      rowsStart,
      bucketSize,
      fullBuckets,
      partialBuckets,
      positionRange,
      positionStep: sectionHeaders.getFloat32(at + 16, true) / 2 / positionRange,
    });
    start = rowsStart + rowBytes * roomFor;
  }
  const used = sections.filter((section) => section.count > 0);
  const total = used.reduce((sum, section) => sum + section.count, 0);
  if (total !== count) fail('damaged', `the header promises ${count} splats, its sections ${total}`, 16);
  return {
    level,
    count,
    shDegree: used.reduce<ShDegree>((most, { shDegree }) => (shDegree > most ? shDegree : most), 0),
    sections: used,
    shLeast: header.getFloat32(36, true) || -SH_RANGE,
    shGreatest: header.getFloat32(40, true) || SH_RANGE,
    bodyBytes: start,
  };
}

/** Throws unless every splat belongs to a bucket. */
function checkBuckets(
  { count, bucketSize, fullBuckets, partialBuckets, lengthsStart }: Section,
  body: DataView,
  file: string,
): void {
  let splats = fullBuckets * bucketSize;
  for (let i = 0; i < partialBuckets; i++) splats += body.getUint32(lengthsStart + 4 * i, true);
  if (splats >= count) return;
  throw new SplatFileError('damaged', file, `the buckets of ${count} splats hold only ${splats}.`);
}

function rowDecoder(
  body: DataView,
  { level, shDegree, sections, shLeast, shGreatest }: Layout,
): (rows: Float32Array, rowCount: number) => void {
  const length = rowLength(shDegree);
  const numberBytes = NUMBER_BYTES[level];
  const coefficientBytes = COEFFICIENT_BYTES[level];
  const values = halfValues();
  const numberAt =
    level > 0
      ? (offset: number) => values[body.getUint16(offset, true)]
      : (offset: number) => body.getFloat32(offset, true);
  const coefficientAt =
    level < 2
      ? numberAt
      : (offset: number) => shLeast + (body.getUint8(offset) / 255) * (shGreatest - shLeast);
  const center = new Float64Array(3);
  let sectionIndex = 0;
  let row = 0;
  let bucket = -1;
  let leftInBucket = 0;
  const nextBucket = ({ fullBuckets, bucketSize, lengthsStart, centersStart }: Section) => {
    bucket++;
    const isFull = bucket < fullBuckets;
    leftInBucket = isFull ? bucketSize : body.getUint32(lengthsStart + 4 * (bucket - fullBuckets), true);
    for (let i = 0; i < 3; i++)
      center[i] = body.getFloat32(centersStart + BUCKET_BYTES * bucket + 4 * i, true);
  };
  return (rows, rowCount) => {
    for (let at = 0; at < rowCount * length; at += length, row++) {
      if (row === sections[sectionIndex].count) {
        sectionIndex++;
        row = 0;
        bucket = -1;
        leftInBucket = 0;
      }
      const section = sections[sectionIndex];
      const { rowsStart, rowBytes, positionRange, positionStep } = section;
      const start = rowsStart + row * rowBytes;
      if (level > 0) {
        while (leftInBucket === 0) nextBucket(section);
        leftInBucket--;
      }
      for (let i = 0; i < 3; i++) {
        rows[at + ROW_SLOT.position + i] =
          level > 0
            ? (body.getUint16(start + 2 * i, true) - positionRange) * positionStep + center[i]
            : body.getFloat32(start + 4 * i, true);
        rows[at + ROW_SLOT.logScale + i] = logScaleOf(numberAt(start + (3 + i) * numberBytes));
      }
      for (let i = 0; i < 4; i++) rows[at + ROW_SLOT.rotation + i] = numberAt(start + (6 + i) * numberBytes);
      const colorStart = start + 10 * numberBytes;
      for (let i = 0; i < 3; i++) rows[at + ROW_SLOT.colorDc + i] = COLORS[body.getUint8(colorStart + i)];
      rows[at + ROW_SLOT.opacity] = LOGITS[body.getUint8(colorStart + 3)];
      const coefficients = coefficientsPerSplat(section.shDegree);
      const sh = at + ROW_SLOT.harmonics;
      for (let i = 0; i < coefficients; i++)
        rows[sh + SH_SLOTS[i]] = coefficientAt(colorStart + 4 + i * coefficientBytes);
      // Sections may have different degrees.
      rows.fill(0, sh + coefficients, at + length);
    }
  };
}

let halves: Float32Array | undefined;

/** Values of all float16 numbers, by their bits; a file has millions. */
function halfValues(): Float32Array {
  halves ??= Float32Array.from(new Uint16Array(1 << 16), (_, bits) => fromHalfBits(bits));
  return halves;
}
