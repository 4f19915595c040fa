import { fileMemory, type WriteFormat } from '../write-format.ts';
import { BrickWriter } from './brick-writer.ts';

/** Fraction of the progress at which all splats have been taken. */
const TAKEN = 0.05;

/**
 * Writes a scene with its levels of detail in bricks, in Morton order: see bricks-layout.ts. Equal
 * sets give equal bytes on one machine.
 *
 * Rounding steps:
 * - positions: 1/16,383 of the bounds of 256 splats
 * - log scales: 1/24
 * - rotation components: 1/180
 * - opacities: 1/255
 * - base coefficients: 1/80
 * - harmonics: 1/72 along the principal axes of 4,096 splats
 *
 * Rejects with InvalidArgumentError 'set' if there are no splats, or if any is not finite.
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
