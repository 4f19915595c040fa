import type { BrickAddress } from '../../../data/bricks/brick.ts';
import { BrickShape } from '../../../data/bricks/brick-shape.ts';
import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import type { ShDegree } from '../../../data/splats/splat-set.ts';
import { crc32 } from '../../containers/crc32.ts';
import { BRICKS_MAGIC, latin1 } from '../first-bytes.ts';
import {
  FILE_HEADER,
  FILE_HEADER_BYTES,
  IS_ANTIALIASED,
  TELLS_ANTIALIASED,
  VERSION,
} from './bricks-layout.ts';

export interface FileHeader {
  readonly splatCount: number;
  readonly shDegree: ShDegree;
  readonly isAntialiased: boolean | undefined;
  readonly origin: Vec3;
  readonly bounds: Bounds;
  readonly robustBounds: Bounds;
  readonly root: BrickAddress;
}

/** Rows are numbered in 32 bits. */
const MOST_SPLATS = 2 ** 32 - 1;
const EXPORT_AGAIN = 'Download or export it again';

export function writeFileHeader(header: FileHeader): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(FILE_HEADER_BYTES);
  const view = new DataView(bytes.buffer);
  for (let i = 0; i < BRICKS_MAGIC.length; i++) bytes[i] = BRICKS_MAGIC.charCodeAt(i);
  const { splatCount, shDegree, isAntialiased, origin, bounds, robustBounds, root } = header;
  view.setUint32(FILE_HEADER.version, VERSION, true);
  view.setBigUint64(FILE_HEADER.splatCount, BigInt(splatCount), true);
  view.setUint32(FILE_HEADER.brickCount, new BrickShape(splatCount).brickCount, true);
  view.setUint8(FILE_HEADER.shDegree, shDegree);
  const flags = (isAntialiased === undefined ? 0 : TELLS_ANTIALIASED) | (isAntialiased ? IS_ANTIALIASED : 0);
  view.setUint8(FILE_HEADER.flags, flags);
  for (const [at, values] of numbersOf(origin, bounds, robustBounds))
    for (const [i, value] of values.entries()) view.setFloat64(at + 8 * i, value, true);
  view.setBigUint64(FILE_HEADER.rootOffset, BigInt(root.offset), true);
  view.setUint32(FILE_HEADER.rootBytes, root.bytes, true);
  view.setUint32(FILE_HEADER.crc, crc32(bytes.subarray(0, FILE_HEADER.crc)), true);
  return bytes;
}

function numbersOf(origin: Vec3, bounds: Bounds, robust: Bounds): [at: number, values: number[]][] {
  return [
    [FILE_HEADER.origin, [...origin]],
    [FILE_HEADER.bounds, [...bounds.min, ...bounds.max]],
    [FILE_HEADER.robustBounds, [...robust.min, ...robust.max]],
  ];
}

/**
 * Reads the file header.
 *
 * @param bytes first bytes of the file; all bytes of a file that is too short.
 * @throws SplatFileError 'unknown-format', 'bad-header', 'truncated', 'damaged', 'too-large',
 *   'empty'
 */
export function readFileHeader(bytes: Uint8Array, file: string): FileHeader {
  const magic = latin1(bytes.subarray(0, BRICKS_MAGIC.length));
  if (magic !== BRICKS_MAGIC.slice(0, magic.length)) {
    const message =
      'it does not begin as a scene in bricks does. Make one with npx @websplatter/cli convert.';
    throw new SplatFileError('unknown-format', file, message, { byte: 0 });
  }
  if (bytes.length < FILE_HEADER_BYTES) {
    const message = `the header takes ${FILE_HEADER_BYTES} bytes, the file has ${bytes.length}. ${EXPORT_AGAIN}.`;
    throw new SplatFileError('truncated', file, message, { byte: bytes.length });
  }
  const view = new DataView(bytes.buffer, bytes.byteOffset, FILE_HEADER_BYTES);
  const version = view.getUint32(FILE_HEADER.version, true);
  if (version !== VERSION) {
    const message = `it is of version ${version}; version ${VERSION} is read. Use a newer version of this library.`;
    throw new SplatFileError('bad-header', file, message, { byte: FILE_HEADER.version });
  }
  const fail = (message: string, byte: number): never => {
    throw new SplatFileError('damaged', file, `${message}. ${EXPORT_AGAIN}.`, { byte });
  };
  if (view.getUint32(FILE_HEADER.crc, true) !== crc32(bytes.subarray(0, FILE_HEADER.crc)))
    fail('its header is not as it was written (CRC-32 differs)', 0);
  const splatCount = Number(view.getBigUint64(FILE_HEADER.splatCount, true));
  if (splatCount === 0)
    throw new SplatFileError('empty', file, 'the header promises 0 splats.', {
      byte: FILE_HEADER.splatCount,
    });
  if (splatCount > MOST_SPLATS) {
    const message = `the header promises ${splatCount} splats; at most ${MOST_SPLATS} can be numbered. Split the scene.`;
    throw new SplatFileError('too-large', file, message, { byte: FILE_HEADER.splatCount });
  }
  const brickCount = view.getUint32(FILE_HEADER.brickCount, true);
  const expected = new BrickShape(splatCount).brickCount;
  if (brickCount !== expected)
    fail(`it has ${brickCount} bricks; ${splatCount} splats make ${expected}`, FILE_HEADER.brickCount);
  const shDegree = view.getUint8(FILE_HEADER.shDegree);
  if (shDegree > 3) fail(`it has harmonics of degree ${shDegree}; there are 0 to 3`, FILE_HEADER.shDegree);
  const vec3 = (at: number): Vec3 => {
    const [x, y, z] = [0, 1, 2].map((axis) => view.getFloat64(at + 8 * axis, true));
    if (![x, y, z].every(Number.isFinite)) fail('its bounds or its origin are not finite', at);
    return [x, y, z];
  };
  const boundsAt = (at: number): Bounds => {
    const [min, max] = [vec3(at), vec3(at + 24)];
    if (min.some((least, axis) => least > max[axis])) fail('its bounds have no inside', at);
    return { min, max };
  };
  const flags = view.getUint8(FILE_HEADER.flags);
  return {
    splatCount,
    shDegree: shDegree as ShDegree,
    isAntialiased: flags & TELLS_ANTIALIASED ? (flags & IS_ANTIALIASED) !== 0 : undefined,
    origin: vec3(FILE_HEADER.origin),
    bounds: boundsAt(FILE_HEADER.bounds),
    robustBounds: boundsAt(FILE_HEADER.robustBounds),
    root: {
      number: 0,
      offset: Number(view.getBigUint64(FILE_HEADER.rootOffset, true)),
      bytes: view.getUint32(FILE_HEADER.rootBytes, true),
    },
  };
}
