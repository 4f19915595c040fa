import type { Plane } from '../clouds/cloud-planes.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { readWords } from '../gpu/read-buffer.ts';

/** Reads the words of a plane of `cloud`, `perSplat` for each splat. */
export async function planeWords(
  { planes }: Pick<SplatCloud, 'planes'>,
  plane: Plane,
  perSplat: number,
): Promise<Uint32Array> {
  if (perSplat === 0) return new Uint32Array(0);
  const pages = await Promise.all(plane.map((page) => readWords(planes.place.memory.device, page)));
  const parts = planes.ranges.map(({ start, end }, i) => pages[i].subarray(0, (end - start) * perSplat));
  return Uint32Array.from(parts.flatMap((part) => Array.from(part)));
}
