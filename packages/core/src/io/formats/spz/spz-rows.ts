import { fromHalfBits } from '../../../data/layout/half.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import type { ByteValues } from '../../../data/packing/row-layout.ts';
import { logitOf, tableOfBytes } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import type { RowSource } from '../rows/arriving-rows.ts';
import { type ByteHarmonics, floatRows } from '../rows/byte-harmonics.ts';
import { type DecodedRows, rowLength } from '../rows/decoded-rows.ts';
import { leftOutBands } from '../rows/left-out-bands.ts';
import type { SpzHeader } from './spz-header.ts';
import { COLOR_SCALE } from './spz-layout.ts';
import { turnToPlyAxes } from './turn-axes.ts';

/** Attribute names, in file order. */
const ATTRIBUTES = ['positions', 'alphas', 'colors', 'scales', 'rotations', 'harmonics'] as const;
type Attribute = (typeof ATTRIBUTES)[number];
/** Bytes of each attribute, splat after splat. */
export type SpzAttributes = Record<Attribute, RowSource>;

export function emptyAttributes(): SpzAttributes {
  const none = { bytes: new Uint8Array(0), start: 0 };
  return { positions: none, alphas: none, colors: none, scales: none, rotations: none, harmonics: none };
}

/** Coefficients above degree 0 per channel, by degree. Only degrees up to 3 are decoded. */
const FILE_COEFFICIENTS = [0, 3, 8, 15, 24];

const bytes = Array.from({ length: 256 }, (_, byte) => byte);
const LOG_SCALES = Float32Array.from(bytes, (byte) => byte / 16 - 10);
const COLORS = Float32Array.from(bytes, (byte) => (byte / 255 - 0.5) / COLOR_SCALE);
/** Logit of each opacity byte; infinite for 0 and 255. */
const OPACITIES = tableOfBytes(logitOf);
const SH_VALUES: ByteValues = { least: -1, most: 127 / 128, scale: 1 / 128, offset: -1 };

/** Bytes per splat of each attribute in a file. */
export function spzAttributeBytes({
  version,
  fileShDegree,
}: SpzHeader): { readonly attribute: Attribute; readonly splatBytes: number }[] {
  const splatBytes: Readonly<Record<Attribute, number>> = {
    positions: version === 1 ? 6 : 9,
    alphas: 1,
    colors: 3,
    scales: 3,
    rotations: version < 3 ? 3 : 4,
    harmonics: 3 * FILE_COEFFICIENTS[fileShDegree],
  };
  return ATTRIBUTES.map((attribute) => ({ attribute, splatBytes: splatBytes[attribute] }));
}

/**
 * Returns the splats of a file, without harmonics of degree 4.
 *
 * @param attributes must have the bytes of all splats that are decoded at once.
 * @param coordinateSystem its number; splats are rotated from it to the axes of PLY. Null: no
 *   rotation.
 */
export function spzRows(
  header: SpzHeader,
  attributes: SpzAttributes,
  coordinateSystem: number | null,
): DecodedRows {
  const { version, count, fileShDegree, fractionalBits, isAntialiased } = header;
  const shDegree = Math.min(fileShDegree, 3) as ShDegree;
  const step = 2 ** -fractionalBits;
  const turn = coordinateSystem === null ? null : turnToPlyAxes(coordinateSystem);
  const sizes = spzAttributeBytes(header);
  const byteHarmonics: ByteHarmonics = {
    source: attributes.harmonics,
    strideBytes: 3 * FILE_COEFFICIENTS[fileShDegree],
    offsets: Array.from({ length: coefficientsPerSplat(shDegree) }, (_, i) => i),
    values: SH_VALUES,
    decodeGeometry(rows, rowCount, length) {
      const { positions, alphas, colors, scales, rotations } = nextBytes(attributes, sizes, rowCount);
      for (let at = 0, splat = 0; splat < rowCount; at += length, splat++) {
        if (version === 1) halfPosition(positions, 6 * splat, rows, at + ROW_SLOT.position);
        else fixedPosition(positions, 9 * splat, step, rows, at + ROW_SLOT.position);
        for (let i = 0; i < 3; i++) {
          rows[at + ROW_SLOT.logScale + i] = LOG_SCALES[scales[3 * splat + i]];
          rows[at + ROW_SLOT.colorDc + i] = COLORS[colors[3 * splat + i]];
        }
        if (version < 3) firstThree(rotations, 3 * splat, rows, at + ROW_SLOT.rotation);
        else smallestThree(rotations, 4 * splat, rows, at + ROW_SLOT.rotation);
        rows[at + ROW_SLOT.opacity] = OPACITIES[alphas[splat]];
      }
    },
  };
  const decode = floatRows(byteHarmonics);
  const note = leftOutBands(fileShDegree);
  return {
    count,
    shDegree,
    isAntialiased,
    fileFacts: {
      format: 'spz',
      variant: String(version),
      ...(note && { notes: [note] }),
    },
    decode(rows, rowCount) {
      decode(rows, rowCount);
      turn?.(rows, rowLength(shDegree), rowCount);
    },
    // Turned harmonics are no bytes.
    ...(!turn && shDegree > 0 && { byteHarmonics }),
  };
}

/** Position of a splat, equal to its row's. @param positions positions of all splats. */
export function spzPosition(
  { version, fractionalBits }: SpzHeader,
  { bytes, start }: RowSource,
  row: number,
): Vec3 {
  const position = new Float32Array(3);
  if (version === 1) halfPosition(bytes, start + 6 * row, position, 0);
  else fixedPosition(bytes, start + 9 * row, 2 ** -fractionalBits, position, 0);
  return [position[0], position[1], position[2]];
}

/** The bytes of the next `rowCount` splats, without their harmonics. */
function nextBytes(
  attributes: SpzAttributes,
  sizes: ReturnType<typeof spzAttributeBytes>,
  rowCount: number,
): Omit<Record<Attribute, Uint8Array>, 'harmonics'> {
  const found = {} as Record<Attribute, Uint8Array>;
  for (const { attribute, splatBytes } of sizes) {
    if (attribute === 'harmonics') continue;
    const source = attributes[attribute];
    const end = source.start + rowCount * splatBytes;
    found[attribute] = source.bytes.subarray(source.start, end);
    source.start = end;
  }
  return found;
}

function halfPosition(bytes: Uint8Array, from: number, rows: Float32Array, at: number): void {
  for (let i = 0; i < 3; i++)
    rows[at + i] = fromHalfBits(bytes[from + 2 * i] | (bytes[from + 2 * i + 1] << 8));
}

function fixedPosition(bytes: Uint8Array, from: number, step: number, rows: Float32Array, at: number): void {
  for (let i = 0; i < 3; i++) {
    const byte = from + 3 * i;
    // Shifted up and back for sign extension.
    rows[at + i] = step * (((bytes[byte] << 8) | (bytes[byte + 1] << 16) | (bytes[byte + 2] << 24)) >> 8);
  }
}

/** Decodes x, y, z from one byte each; w is not negative. */
function firstThree(bytes: Uint8Array, from: number, rows: Float32Array, at: number): void {
  let squares = 0;
  for (let i = 0; i < 3; i++) {
    const value = bytes[from + i] / 127.5 - 1;
    rows[at + 1 + i] = value;
    squares += value * value;
  }
  rows[at] = Math.sqrt(Math.max(0, 1 - squares));
}

/**
 * Decodes x, y, z, w without the largest, whose index is in the top bits. The others have 9 bits
 * and a sign, x highest.
 */
function smallestThree(bytes: Uint8Array, from: number, rows: Float32Array, at: number): void {
  let word = bytes[from] | (bytes[from + 1] << 8) | (bytes[from + 2] << 16) | (bytes[from + 3] << 24);
  const largest = word >>> 30;
  let squares = 0;
  for (let i = 3; i >= 0; i--) {
    if (i === largest) continue;
    const magnitude = ((word & 511) / 511) * Math.SQRT1_2;
    rows[at + ((i + 1) & 3)] = word & 512 ? -magnitude : magnitude;
    squares += magnitude * magnitude;
    word >>>= 10;
  }
  rows[at + ((largest + 1) & 3)] = Math.sqrt(Math.max(0, 1 - squares));
}
