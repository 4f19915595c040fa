import type { Brick, BrickAddress, BrickScene } from '../../../data/bricks/brick.ts';
import { BrickShape } from '../../../data/bricks/brick-shape.ts';
import { BLOB_WORDS, packBlob, SPLAT_WORDS } from '../../../data/bricks/leaf-reader.ts';
import { SplatFileError } from '../../../data/errors.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { logScalesOf } from '../../../data/packing/chunks.ts';
import { packGeometry } from '../../../data/packing/geometry.ts';
import { packCoefficients, shWordsPerSplat } from '../../../data/packing/harmonics.ts';
import { clampLogScale } from '../../../data/packing/log-scale.ts';
import { BLOB_PRECISION } from '../../../data/packing/precision.ts';
import { logitOf } from '../../../data/splats/color-values.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import type { Turns } from '../../../data/turns.ts';
import { unpackZlib } from '../../containers/gzip.ts';
import { type BrickHeader, readBrickHeader } from './brick-header.ts';
import { brickHeaderBytes, geometryBytes, mostHarmonicsBytes } from './bricks-layout.ts';
import { decodeGeometry, type LeafColumns } from './decode-geometry.ts';
import { decodeHarmonics } from './decode-harmonics.ts';

/** Facts about the file that a brick does not contain itself. */
export type BrickFile = Pick<BrickScene, 'name' | 'splatCount' | 'shDegree'>;

/** A decoded brick, before it is packed for the GPU. */
export interface DecodedBrick {
  readonly header: BrickHeader;
  readonly leaves: LeafColumns;
  /** 3K spherical-harmonic coefficients per leaf. */
  readonly coefficients: Float32Array;
}

/**
 * Decodes the brick at `address`.
 *
 * Rejects with SplatFileError 'damaged', and with the reason of the turns' signal.
 *
 * @param bytes all bytes of the brick.
 */
export async function decodeBrick(
  bytes: Uint8Array<ArrayBuffer>,
  address: BrickAddress,
  shape: BrickShape,
  degree: ShDegree,
  file: string,
  turns: Turns,
): Promise<DecodedBrick> {
  const header = readBrickHeader(bytes, address, shape, file);
  const { level, first, end, cells } = header;
  const start = brickHeaderBytes(level, end - first);
  const total = start + header.geometryBytes + header.harmonicsBytes;
  const fail = (message: string): never => {
    const text = `brick ${address.number} ${message}. Download or export it again.`;
    throw new SplatFileError('damaged', file, text, { byte: address.offset });
  };
  if (total !== bytes.length) fail(`has parts of ${total} bytes together, and ${bytes.length} bytes`);
  const count = shape.leafCountOf(header);
  const middle = start + header.geometryBytes;
  const unpack = (from: number, to: number, mostBytes: number, what: string) =>
    unpackZlib(
      bytes.subarray(from, to),
      mostBytes,
      `${file}, ${what} of brick ${address.number}`,
      address.offset + from,
    );
  const [geometry, harmonics] = await Promise.all([
    unpack(start, middle, geometryBytes(level, count), 'geometry'),
    degree > 0 ? unpack(middle, total, mostHarmonicsBytes(degree, count), 'harmonics') : null,
  ]);
  if (geometry.length !== geometryBytes(level, count))
    fail(`has ${geometry.length} bytes of geometry; ${count} leaves have ${geometryBytes(level, count)}`);
  const bounds = cells.map((cell) => cell.bounds);
  await turns.give();
  const leaves = decodeGeometry(geometry, level, count, bounds) ?? fail('has colours that no file has');
  const coefficients = harmonics
    ? await decodeHarmonics(harmonics, degree, count, turns)
    : new Float32Array(0);
  return { header, leaves, coefficients: coefficients ?? fail('has harmonics that cannot be read') };
}

/**
 * Decodes the brick at `address` and packs it for the GPU. Rejects as `decodeBrick`, and with
 * SplatFileError 'truncated' if bytes are missing.
 */
export async function readBrick(
  bytes: Uint8Array<ArrayBuffer>,
  address: BrickAddress,
  { name, splatCount, shDegree }: BrickFile,
  turns: Turns,
): Promise<Brick> {
  const { number, offset, bytes: byteCount } = address;
  if (bytes.length < byteCount) {
    const message = `brick ${number} takes ${byteCount} bytes, of which the file has ${bytes.length}. Download or export it again.`;
    throw new SplatFileError('truncated', name, message, { byte: offset + bytes.length });
  }
  const decoded = await decodeBrick(bytes, address, new BrickShape(splatCount), shDegree, name, turns);
  await turns.give();
  return packBrick(decoded, shDegree);
}

function packBrick({ header, leaves, coefficients }: DecodedBrick, degree: ShDegree): Brick {
  const { level, first, end, cells } = header;
  const places = CHUNK_SPLATS * (end - first);
  const { count } = leaves;
  const width = coefficientsPerSplat(degree);
  const shWords = shWordsPerSplat(degree, BLOB_PRECISION.shPrecision);
  const harmonics = new Uint32Array(places * shWords);
  for (let i = 0; i < count && width > 0; i++) {
    const values = coefficients.subarray(i * width, (i + 1) * width);
    packCoefficients(degree, BLOB_PRECISION.shPrecision, values, harmonics, i * shWords);
  }
  if (level > 0) {
    const blobCells = cells.map((cell) => ({ ...cell, logScales: [0, 0] as const }));
    return {
      level,
      cells: blobCells,
      geometry: packBlobs(leaves, places),
      harmonics,
      fileIndices: new Uint32Array(0),
    };
  }
  const fileIndices = new Uint32Array(places);
  for (let i = 0; i < count; i++) fileIndices[i] = CHUNK_SPLATS * first + i;
  const { words, chunks } = packGeometry(
    {
      ...{ ...leaves, origin: [0, 0, 0], fileIndices, dropped: {} },
      opacityLogits: leaves.opacities.map(logitOf),
    },
    'packed',
  );
  const geometry = new Uint32Array(places * SPLAT_WORDS);
  geometry.set(words);
  const splatCells = cells.map((cell, i) => {
    const { min, step } = logScalesOf(chunks, i);
    return { ...cell, logScales: [min, step] as const };
  });
  return { level, cells: splatCells, geometry, harmonics, fileIndices };
}

function packBlobs(leaves: LeafColumns, places: number): Uint32Array<ArrayBuffer> {
  const geometry = new Uint32Array(places * BLOB_WORDS);
  const { count, positions, logScales, rotations, opacities, colorDc, sums } = leaves;
  for (let i = 0; i < count; i++) {
    const blob = {
      position: positions.subarray(3 * i, 3 * i + 3),
      opacity: opacities[i],
      rotation: rotations.subarray(4 * i, 4 * i + 4),
      scale: logScales.subarray(3 * i, 3 * i + 3).map((value) => Math.exp(clampLogScale(value))),
      colorDc: colorDc.subarray(3 * i, 3 * i + 3),
      sums: sums.subarray(2 * i, 2 * i + 2),
    };
    packBlob(blob, geometry, i * BLOB_WORDS);
  }
  return geometry;
}
