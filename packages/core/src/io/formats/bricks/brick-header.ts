import type { Brick, BrickAddress, BrickCell } from '../../../data/bricks/brick.ts';
import type { BrickCells, BrickShape } from '../../../data/bricks/brick-shape.ts';
import { SplatFileError } from '../../../data/errors.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import { crc32 } from '../../containers/crc32.ts';
import { BRICK_HEADER, brickHeaderBytes, CELL, SCALE_ROUNDING, UPPER_CELL } from './bricks-layout.ts';

const { ERROR_BOUNDLESS } = LEVEL_CONSTANTS;

/** A parsed brick header: the cells of the brick and their bounds. */
export interface BrickHeader extends BrickCells {
  /** Cells without `logScales`: the range of log scales is computed from decoded leaves. */
  readonly cells: readonly Omit<BrickCell, 'logScales'>[];
  readonly geometryBytes: number;
  readonly harmonicsBytes: number;
}

/** The fields of a cell that are stored in the brick header. */
interface WrittenCell extends Pick<BrickCell, 'bounds' | 'largestScale'> {
  readonly child: Pick<BrickAddress, 'number'> | null;
  readonly childErrors: ArrayLike<number>;
}

/** @param addressOf returns the byte range of the brick with this index. */
export function writeBrickHeader(
  { level, cells }: Pick<Brick, 'level'> & { readonly cells: readonly WrittenCell[] },
  number: number,
  parts: Pick<BrickHeader, 'geometryBytes' | 'harmonicsBytes'>,
  addressOf: (number: number) => BrickAddress,
): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(brickHeaderBytes(level, cells.length));
  const view = new DataView(bytes.buffer);
  view.setUint32(BRICK_HEADER.number, number, true);
  view.setUint32(BRICK_HEADER.geometryBytes, parts.geometryBytes, true);
  view.setUint32(BRICK_HEADER.harmonicsBytes, parts.harmonicsBytes, true);
  for (const [i, { bounds, largestScale, child, childErrors }] of cells.entries()) {
    const at = BRICK_HEADER.cells + i * (level === 0 ? CELL.bytes : UPPER_CELL.bytes);
    for (const [k, value] of [...bounds.min, ...bounds.max].entries())
      view.setFloat32(at + CELL.bounds + 4 * k, value, true);
    view.setFloat32(at + CELL.largestScale, SCALE_ROUNDING * largestScale, true);
    if (!child) continue;
    const { offset, bytes: childBytes } = addressOf(child.number);
    if (i === 0) view.setBigUint64(BRICK_HEADER.childrenOffset, BigInt(offset), true);
    view.setUint32(at + UPPER_CELL.childBytes, childBytes, true);
    for (const [k, error] of Array.from(childErrors).entries())
      view.setUint16(at + UPPER_CELL.childErrors + 2 * k, error, true);
  }
  view.setUint32(BRICK_HEADER.crc, crc32(bytes.subarray(BRICK_HEADER.number)), true);
  return bytes;
}

/**
 * Reads the header of the brick at `address`.
 *
 * @param bytes bytes from `address` on, at least the whole header.
 * @throws SplatFileError 'damaged'
 */
export function readBrickHeader(
  bytes: Uint8Array,
  { number, offset }: Pick<BrickAddress, 'number' | 'offset'>,
  shape: BrickShape,
  file: string,
): BrickHeader {
  const fail = (message: string, place: number): never => {
    const text = `${message}. Download or export it again.`;
    throw new SplatFileError('damaged', file, `brick ${number} ${text}`, { byte: offset + place });
  };
  const { level, first, end } = shape.cellsOf(number);
  const headerBytes = brickHeaderBytes(level, end - first);
  const view = new DataView(bytes.buffer, bytes.byteOffset, headerBytes);
  if (view.getUint32(BRICK_HEADER.crc, true) !== crc32(bytes.subarray(BRICK_HEADER.number, headerBytes)))
    fail('is not as it was written (CRC-32 of its header differs)', BRICK_HEADER.crc);
  const found = view.getUint32(BRICK_HEADER.number, true);
  if (found !== number) fail(`says that it is brick ${found}`, BRICK_HEADER.number);
  const geometryBytes = view.getUint32(BRICK_HEADER.geometryBytes, true);
  const harmonicsBytes = view.getUint32(BRICK_HEADER.harmonicsBytes, true);
  const ownEnd = offset + headerBytes + geometryBytes + harmonicsBytes;
  let childOffset = Number(view.getBigUint64(BRICK_HEADER.childrenOffset, true));
  if (level > 0 && !(childOffset >= ownEnd && childOffset <= Number.MAX_SAFE_INTEGER))
    fail(`has bricks below it at byte ${childOffset}, not after it`, BRICK_HEADER.childrenOffset);
  const cells: Omit<BrickCell, 'logScales'>[] = [];
  for (let cell = first; cell < end; cell++) {
    const at = BRICK_HEADER.cells + (cell - first) * (level === 0 ? CELL.bytes : UPPER_CELL.bytes);
    const sides = Array.from({ length: 6 }, (_, k) => view.getFloat32(at + CELL.bounds + 4 * k, true));
    const [minX, minY, minZ, maxX, maxY, maxZ] = sides;
    if (!(minX <= maxX && minY <= maxY && minZ <= maxZ && sides.every(Number.isFinite)))
      fail(`has a cell, ${cell - first}, whose bounds have no inside`, at);
    const largestScale = view.getFloat32(at + CELL.largestScale, true);
    if (!(largestScale >= 0 && Number.isFinite(largestScale)))
      fail(`has a cell, ${cell - first}, whose largest splat has a scale of ${largestScale}`, at);
    const own = {
      largestScale,
      bounds: { min: [minX, minY, minZ], max: [maxX, maxY, maxZ] },
      leafCount: shape.leavesOf(level, cell),
    } as const;
    if (level === 0) {
      cells.push({ ...own, child: null, childErrors: [], childRoots: [] });
      continue;
    }
    const childBytes = view.getUint32(at + UPPER_CELL.childBytes, true);
    const childRoots = shape.childRootsOf(level, cell);
    const childErrors = childRoots.map((_, k) => view.getUint16(at + UPPER_CELL.childErrors + 2 * k, true));
    const wrong = childErrors.find((error) => error < 1 || error >= ERROR_BOUNDLESS);
    if (wrong !== undefined)
      fail(`has an error of ${wrong}, which is not from 1 to ${ERROR_BOUNDLESS - 1}`, at);
    const child = { number: shape.childOf(level, cell), offset: childOffset, bytes: childBytes };
    cells.push({ ...own, child, childErrors, childRoots });
    childOffset += childBytes;
  }
  return { level, first, end, cells, geometryBytes, harmonicsBytes };
}

/**
 * Checks a brick against the cell above it, whose bounds and errors include its own.
 *
 * @throws SplatFileError 'damaged'
 */
export function checkNested(
  { cells }: Pick<BrickHeader, 'cells'>,
  above: Omit<BrickCell, 'logScales'>,
  { number, offset }: BrickAddress,
  file: string,
): void {
  const fail = (message: string): never => {
    const text = `brick ${number} has a cell ${message}. Download or export it again.`;
    throw new SplatFileError('damaged', file, text, { byte: offset });
  };
  for (const [i, { bounds, largestScale, childErrors }] of cells.entries()) {
    if (largestScale > above.largestScale) fail(`${i} with larger splats than the one above it`);
    const isWithin = [0, 1, 2].every(
      (axis) => bounds.min[axis] >= above.bounds.min[axis] && bounds.max[axis] <= above.bounds.max[axis],
    );
    if (!isWithin) fail(`${i} that is not within the one above it`);
    const own = above.childErrors[i];
    const larger = childErrors.find((error) => error > own);
    if (larger !== undefined) fail(`${i} with an error of ${larger} below it, larger than its own, ${own}`);
  }
}
