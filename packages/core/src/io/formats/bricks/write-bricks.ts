import { fileMemory, type WriteFormat } from '../write-format.ts';
import { BrickWriter } from './brick-writer.ts';

/** Part of the work that is done when all splats are taken. */
const TAKEN = 0.05;

/**
 * Writes a scene with its levels of detail in bricks, in Morton order: see bricks-layout.ts. It
 * rounds positions to 16,383 steps of the bounds of 256 splats, log scales to 1/24, components of
 * rotations to 1/180, opacities to 1/255, base coefficients to 1/80, and harmonics to 1/72 along
 * the principal axes of 4,096 splats. Equal sets give equal bytes on one machine.
 *
 * Rejects with InvalidArgumentError 'set' for no splats, or any that is not finite.
 */
export const write: WriteFormat = async (set, { signal, onProgress, onNote }) => {
  const writer = new BrickWriter({ signal });
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let byteCount = 0;
  try {
    await writer.add(set);
    onProgress?.(TAKEN);
    await writer.finish(
      async (part) => {
        parts.push(part);
        byteCount += part.length;
      },
      (fraction) => onProgress?.(TAKEN + (1 - TAKEN) * fraction),
    );
    for (const note of writer.notes) onNote?.(note);
  } finally {
    await writer.end();
  }
  const file = fileMemory(byteCount);
  let at = 0;
  for (const part of parts) {
    file.set(part, at);
    at += part.length;
  }
  return file;
};
