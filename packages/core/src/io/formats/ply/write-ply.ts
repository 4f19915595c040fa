import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { givenSet } from '../../../data/splats/check-set.ts';
import { coefficientsPerSplat, type SplatColumns, type SplatSet } from '../../../data/splats/splat-set.ts';
import { MOTION_VALUES } from '../../../features/motion/splat-motion.data.ts';
import type { PieceFacts } from '../rows/piece-facts.ts';
import {
  fileMemory,
  readInTurns,
  type WriteFormat,
  type WritePieces,
  writeInTurns,
} from '../write-format.ts';
import { HARMONICS_COMMENT, MOTION_PROPERTIES } from './motion-properties.ts';

/**
 * Encodes `set` as a binary little-endian PLY in the standard 3DGS layout, without normals.
 * Properties are float32 x y z, f_dc, f_rest (all of red, then green, then blue), opacity, scale,
 * rot and, of a moving scene, its motion. Comments state whether there was an antialias filter, if
 * known, and that the f_dc of a moving scene are harmonics. Rows keep the set's order;
 * `fileIndices` and `dropped` are lost.
 *
 * If the origin is not 0, x y z are doubles that include it, because float32 would lose precision.
 * A set from a file, written and read again at shPrecision f32, has the same bits. Throws
 * RangeError if no ArrayBuffer can be that large.
 *
 * @example
 * const set = await readSplats('/garden.spz');
 * const file = new File([encodePly(set)], 'garden.ply');
 */
export function encodePly(set: SplatSet<Harmonics>): Uint8Array<ArrayBuffer> {
  const { bytes, putRows } = plyOf(set);
  putRows(0, set.count);
  return bytes;
}

/** As `encodePly`, but yields to the event loop. */
export const write: WriteFormat = async (set, options) => {
  const { bytes, putRows } = plyOf(set, fileMemory);
  await writeInTurns(set.count, options, putRows);
  return bytes;
};

/** Comment lines that state whether there was an antialias filter; empty if unknown. */
export function antialiasComments({ isAntialiased }: Pick<SplatColumns, 'isAntialiased'>): string[] {
  if (isAntialiased === undefined) return [];
  // The comment of Brush, which other readers recognise.
  return [`comment SplatRenderMode: ${isAntialiased ? 'mip' : 'default'}`];
}

/** As `write`, in one pass over the pieces. */
export const writePieces: WritePieces = async (pieces, options, put) => {
  const { facts } = pieces;
  const { header, strideBytes, putRows } = layoutOf({
    count: facts.count,
    shDegree: facts.shDegree,
    isAntialiased: facts.isAntialiased,
    isWide: facts.isWide,
    isMoving: facts.timeRange !== null,
  });
  await put(header);
  await readInTurns(pieces, options, async (piece) => {
    const rows = new Uint8Array(piece.count * strideBytes);
    putRows(piece, 0, piece.count, new DataView(rows.buffer));
    await put(rows);
  });
};

/** The header of a file, and a function that writes rows into it. */
function plyOf(
  set: SplatSet<Harmonics>,
  memoryOf = (byteCount: number) => new Uint8Array(byteCount),
): { bytes: Uint8Array<ArrayBuffer>; putRows(from: number, to: number): void } {
  const { header, strideBytes, putRows } = layoutOf({
    ...set,
    shDegree: givenSet(set).harmonics.degree,
    isAntialiased: set.isAntialiased,
    isWide: set.origin.some((value) => value !== 0),
    isMoving: set.motion !== undefined,
  });
  const bytes = memoryOf(header.length + set.count * strideBytes);
  bytes.set(header);
  const view = new DataView(bytes.buffer, header.length);
  return { bytes, putRows: (from, to) => putRows(set, from, to, view) };
}

interface PlyFacts extends Pick<PieceFacts, 'count' | 'shDegree' | 'isAntialiased' | 'isWide'> {
  readonly isMoving: boolean;
}

interface Layout {
  readonly header: Uint8Array<ArrayBuffer>;
  readonly strideBytes: number;
  /** Writes rows of a set to `view`, which begins with the first of them. */
  putRows(set: SplatSet<Harmonics>, from: number, to: number, view: DataView): void;
}

function layoutOf(facts: PlyFacts): Layout {
  const shValues = coefficientsPerSplat(facts.shDegree);
  const { isWide, isMoving } = facts;
  const motionValues = isMoving ? MOTION_VALUES : 0;
  const positionBytes = isWide ? 8 : 4;
  const header = new TextEncoder().encode(headerText(facts, shValues, isWide ? 'double' : 'float'));
  const strideBytes = 3 * positionBytes + 4 * (3 + shValues + 1 + 3 + 4 + motionValues);
  const sh = new Float32Array(shValues);
  const putRows: Layout['putRows'] = (set, from, to, view) => {
    let offset = from * strideBytes;
    const put = (value: number) => {
      view.setFloat32(offset, value, true);
      offset += 4;
    };
    for (let i = from; i < to; i++) {
      for (let axis = 0; axis < 3; axis++) {
        const position = absolute(set.positions[3 * i + axis], set.origin[axis]);
        if (isWide) view.setFloat64(offset, position, true);
        else view.setFloat32(offset, position, true);
        offset += positionBytes;
      }
      for (let channel = 0; channel < 3; channel++) put(set.colorDc[3 * i + channel]);
      readCoefficients(set.harmonics, i, sh);
      for (let channel = 0; channel < 3; channel++) for (let k = channel; k < shValues; k += 3) put(sh[k]);
      put(set.opacityLogits[i]);
      for (let axis = 0; axis < 3; axis++) put(set.logScales[3 * i + axis]);
      for (let part = 0; part < 4; part++) put(set.rotations[4 * i + part]);
      for (let k = 0; k < motionValues; k++) put(set.motion![i * MOTION_VALUES + k]);
    }
  };
  return { header, strideBytes, putRows };
}

/** Adding 0 would turn −0 into +0. */
function absolute(position: number, origin: number): number {
  return origin === 0 ? position : position + origin;
}

function headerText(facts: PlyFacts, shValues: number, positionType: 'float' | 'double'): string {
  const floats = [
    ...names('f_dc', 3),
    ...names('f_rest', shValues),
    'opacity',
    ...names('scale', 3),
    ...names('rot', 4),
    ...(facts.isMoving ? MOTION_PROPERTIES : []),
  ];
  return [
    'ply',
    'format binary_little_endian 1.0',
    ...antialiasComments(facts),
    ...(facts.isMoving ? [`comment ${HARMONICS_COMMENT}`] : []),
    `element vertex ${facts.count}`,
    ...['x', 'y', 'z'].map((name) => `property ${positionType} ${name}`),
    ...floats.map((name) => `property float ${name}`),
    'end_header',
    '',
  ].join('\n');
}

function names(stem: string, count: number): string[] {
  return Array.from({ length: count }, (_, i) => `${stem}_${i}`);
}
