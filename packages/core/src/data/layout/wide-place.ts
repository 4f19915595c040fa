import type { CloudView } from '../camera/cloud-view.ts';
import { gpuStruct } from './gpu-struct.ts';

/** A page's place in float64, for wide sort keys. A float64 is two words, the low one first. */
export const WidePlace = gpuStruct('WidePlace', {
  /** Upper word of the ordered bits of a depth that no splat of the frame lies beyond. */
  farthestHigh: 'u32',
  /** Cloud space to view space, row by row: x and y, then z and the cloud's origin. */
  rows: 'array<vec4u, 6>',
});

/** Writes a `WidePlace` at `byteOffset`, a multiple of 16. */
export function writeWidePlace(
  target: ArrayBuffer,
  { linear, translation }: Pick<CloudView, 'linear' | 'translation'>,
  farthestHigh: number,
  byteOffset: number,
): void {
  new Uint32Array(target, byteOffset, 1)[0] = farthestHigh;
  const rows = new Float64Array(target, byteOffset + WidePlace.offsets.rows, 12);
  for (let row = 0; row < 3; row++) {
    for (let axis = 0; axis < 3; axis++) rows[4 * row + axis] = linear[3 * axis + row];
    rows[4 * row + 3] = translation[row];
  }
}
