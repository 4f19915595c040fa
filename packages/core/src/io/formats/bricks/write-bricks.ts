import type { Brick, BrickAddress } from '../../../data/bricks/brick.ts';
import { makeBricksInTurns } from '../../../data/bricks/make-bricks.ts';
import { Turns } from '../../../data/turns.ts';
import { packZlib } from '../../containers/pack-gzip.ts';
import { fileMemory, type WriteFormat } from '../write-format.ts';
import { writeBrickHeader } from './brick-header.ts';
import { brickHeaderBytes, FILE_HEADER_BYTES } from './bricks-layout.ts';
import { encodeGeometry } from './encode-geometry.ts';
import { encodeHarmonics } from './encode-harmonics.ts';
import { writeFileHeader } from './file-header.ts';

/** Part of the work that is done when all cells are merged. */
const MERGED = 0.3;
const NOTHING = new Uint8Array(0);

/**
 * Writes a scene with its levels of detail in bricks, in Morton order: see bricks-layout.ts. It
 * rounds positions to 16,383 steps of the bounds of 256 splats, log scales to 1/24, components of
 * rotations to 1/180, opacities to 1/255, base coefficients to 1/80, and harmonics to 1/72 along
 * the principal axes of 4,096 splats. Equal sets give equal bytes on one machine.
 *
 * Rejects with InvalidArgumentError 'set' for no splats, or any that is not finite.
 */
export const write: WriteFormat = async (set, { signal, onProgress }) => {
  const turns = new Turns(signal);
  const made = await makeBricksInTurns(set, turns, (fraction) => onProgress?.(MERGED * fraction));
  const { shape, cloud } = made;
  const { degree } = cloud.harmonics;
  const parts: PackedParts[] = [];
  const addresses: BrickAddress[] = [];
  let offset = FILE_HEADER_BYTES;
  for (const brick of made.bricks()) {
    await turns.give();
    const [geometry, harmonics] = await Promise.all([
      packZlib(encodeGeometry(brick)),
      degree > 0 ? packZlib(encodeHarmonics(brick, degree)) : NOTHING,
    ]);
    const number = parts.length;
    const bytes = brickHeaderBytes(brick.level, brick.cells.length) + geometry.length + harmonics.length;
    parts.push({ cells: brick.cells, level: brick.level, geometry, harmonics });
    addresses.push({ number, offset, bytes });
    offset += bytes;
    onProgress?.(MERGED + ((1 - MERGED) * parts.length) / shape.brickCount);
  }
  signal?.throwIfAborted();
  const file = fileMemory(offset);
  const { count, origin, bounds, robustBounds } = cloud;
  file.set(
    writeFileHeader({
      ...{ splatCount: count, shDegree: degree, origin, bounds, robustBounds, root: addresses[0] },
      isAntialiased: set.isAntialiased,
    }),
  );
  for (const [number, { geometry, harmonics, ...brick }] of parts.entries()) {
    const sizes = { geometryBytes: geometry.length, harmonicsBytes: harmonics.length };
    const header = writeBrickHeader(brick, number, sizes, (child) => addresses[child]);
    let at = addresses[number].offset;
    for (const part of [header, geometry, harmonics]) {
      file.set(part, at);
      at += part.length;
    }
  }
  return file;
};

/** What a brick takes in the file. */
interface PackedParts extends Pick<Brick, 'level' | 'cells'> {
  readonly geometry: Uint8Array<ArrayBuffer>;
  readonly harmonics: Uint8Array<ArrayBuffer>;
}
