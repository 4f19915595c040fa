import { depthKey, shortDepthKey } from '../layout/depth-key.ts';
import type { InspectedFrame } from './inspected-frame.ts';
import { readRecords } from './read-records.ts';

/**
 * What is wrong with the frame's keys and order; nothing where they are right. Integers leave no room: keys are those
 * of the depths written, shortened where the frame's accuracy says so, and the order is their stable ascending one, by as
 * many low bits as the sort looks at.
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
  // More than one pass sorts the keys themselves along.
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

/** Null where `order` names every key once, in ascending order, equal keys in their given order; else what is wrong. */
export function orderFlaw(keys: Uint32Array, order: Uint32Array): string | null {
  if (order.length !== keys.length) return `${order.length} places for ${keys.length} keys`;
  const seen = new Uint8Array(keys.length);
  for (const [place, index] of order.entries()) {
    if (index >= keys.length || seen[index])
      return `order: place ${place} holds ${index}, which is out of range or there already`;
    seen[index] = 1;
    if (place === 0) continue;
    const before = order[place - 1];
    const isOrdered = keys[before] < keys[index] || (keys[before] === keys[index] && before < index);
    if (!isOrdered)
      return `order: place ${place - 1} holds key ${keys[before]} (of ${before}), place ${place} holds ${keys[index]} (of ${index})`;
  }
  return null;
}
