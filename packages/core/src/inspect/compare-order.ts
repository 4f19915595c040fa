import { depthKey, shortDepthKey } from '../layout/depth-key.ts';
import type { InspectedFrame } from './inspected-frame.ts';
import { readRecords } from './read-records.ts';

/**
 * Lists the flaws of the frame's keys and order; empty if there are none. Integers leave no tolerance: the keys must be
 * those of the records' depths, shortened if the frame's accuracy requires it, and the order must be their stable ascending
 * order by as many low bits as the sort reads.
 */
export async function compareOrder(frame: InspectedFrame): Promise<string[]> {
  const { passes, digitBits } = frame.parts.sort.sort.shape;
  const { shortensKeys } = frame.plan.shape;
  const [farthest, nearestInverted] = await frame.words('depthRange');
  const nearest = ~nearestInverted >>> 0;
  const expected = Uint32Array.from(await readRecords(frame), ({ depthView }) =>
    shortensKeys
      ? shortDepthKey(depthView, farthest, nearest, frame.accuracy.sortKeyBits)
      : depthKey(depthView, farthest),
  );
  const flaws: string[] = [];
  // With more than one pass, the keys are overwritten while they are sorted.
  if (passes === 1) {
    const keys = await frame.sorted('keys');
    const at = expected.findIndex((key, i) => key !== keys[i]);
    if (at >= 0) flaws.push(`key of visible splat ${at}: got ${keys[at]}, expected ${expected[at]}`);
  }
  const sortedBits = Math.min(32, passes * digitBits);
  const order = await frame.sorted('order');
  const flaw = orderFlaw(
    expected.map((key) => key % 2 ** sortedBits),
    order,
  );
  if (flaw) flaws.push(flaw);
  const drawn = await frame.words('drawArguments');
  if (drawn[1] !== expected.length)
    flaws.push(`instances drawn: got ${drawn[1]}, expected ${expected.length}`);
  return flaws;
}

/** Describes the first flaw of `order`; null if it names every key once, in ascending order, equal keys in given order. */
export function orderFlaw(keys: Uint32Array, order: Uint32Array): string | null {
  if (order.length !== keys.length) return `${order.length} places for ${keys.length} keys`;
  const seen = new Uint8Array(keys.length);
  for (const [place, index] of order.entries()) {
    if (index >= keys.length || seen[index])
      return `order: place ${place} holds ${index}, which is out of range or a duplicate`;
    seen[index] = 1;
    if (place === 0) continue;
    const before = order[place - 1];
    const isOrdered = keys[before] < keys[index] || (keys[before] === keys[index] && before < index);
    if (!isOrdered)
      return `order: place ${place - 1} holds key ${keys[before]} (of ${before}), place ${place} holds ${keys[index]} (of ${index})`;
  }
  return null;
}
