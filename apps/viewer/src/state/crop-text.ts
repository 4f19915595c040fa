import { InvalidArgumentError } from '@websplatter/core';
import { numberPart } from './address-parts.ts';
import type { Crop } from './inspecting.ts';
import type { Vec3 } from './vec3.ts';

/**
 * For the address: both corners of the box in the scene's own space, and which splats stay:
 * `-1:0:-1:1:2:1:inside`. Numbers are the shortest that read back as the same float64.
 */
export function encodeCrop({ min, max, keep }: Crop): string {
  return [...min, ...max, keep].join(':');
}

/**
 * Reads the text of `encodeCrop`.
 *
 * @throws InvalidArgumentError naming the part that cannot be, and how a crop is written.
 */
export function decodeCrop(text: string): Crop {
  const parts = text.split(':').map((part) => part.trim());
  if (parts.length !== 7) throw refused(`it has ${parts.length} parts`);
  const numbers = parts.slice(0, 6).map((part) => numberPart(part, refused));
  const keep = parts[6];
  if (keep !== 'inside' && keep !== 'outside') throw refused(`“${keep}” is neither inside nor outside`);
  const [x0, y0, z0, x1, y1, z1] = numbers;
  const [min, max]: Vec3[] = [
    [x0, y0, z0],
    [x1, y1, z1],
  ];
  const axis = [0, 1, 2].find((each) => min[each] > max[each]);
  if (axis !== undefined)
    throw refused(`its min ${'xyz'[axis]}, ${min[axis]}, is above its max, ${max[axis]}`);
  return { min, max, keep };
}

function refused(why: string): InvalidArgumentError {
  const form = 'write crop=x:y:z:x:y:z:inside, with the min and then the max corner, or outside';
  return new InvalidArgumentError('crop', `The crop of the address cannot be read: ${why}; ${form}.`);
}
