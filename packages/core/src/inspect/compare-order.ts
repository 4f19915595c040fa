import { depthKey, shortDepthKey } from '../data/layout/depth-key.ts';
import { hasWideKeys } from '../frame/plan/frame-shape.ts';
import type { InspectedFrame } from './inspected-frame.ts';
import { orderedDepths, type SortDepth, sortDepths } from './sort-depths.ts';

/** The least and the largest key that a splat may have. */
export interface KeyBounds {
  readonly least: number;
  readonly most: number;
}

/**
 * Lists the flaws of the frame's keys and order; empty if there are none. Integers leave no
 * tolerance. Keys must equal the keys of the records' depths, shortened if the frame's accuracy
 * requires it. The order must be the stable ascending order of the keys' low bits that the sort
 * reads. Wide keys are compared by the order of the reference's depths alone. Distances have the
 * bounds of `sortDepths`: keys and order must be possible within the bounds.
 */
export async function compareOrder(frame: InspectedFrame): Promise<string[]> {
  const { shape } = frame.plan;
  const flaws = hasWideKeys(shape)
    ? [orderFlaw(ranksOf(await orderedDepths(frame)), await frame.sorted('order'))]
    : await narrowOrderFlaws(frame);
  const drawn = await frame.words('drawArguments');
  const count = await frame.visibleCount();
  if (drawn[1] !== count) flaws.push(`instances drawn: got ${drawn[1]}, expected ${count}`);
  return flaws.filter((flaw) => flaw !== null);
}

/** Rank of each depth among all depths, the farthest first: keys with the same order. */
function ranksOf(depths: readonly SortDepth[]): KeyBounds[] {
  const all = [...new Set(depths.flatMap(({ least, most }) => [least, most]))].sort((a, b) => b - a);
  const rankOf = new Map(all.map((depth, rank) => [depth, rank]));
  return depths.map(({ least, most }) => ({ least: rankOf.get(most)!, most: rankOf.get(least)! }));
}

async function narrowOrderFlaws(frame: InspectedFrame): Promise<(string | null)[]> {
  const { passes, digitBits } = frame.parts.sort.sort.shape;
  const { shortensKeys } = frame.plan.shape;
  const [farthest, nearestInverted] = await frame.words('depthRange');
  const nearest = ~nearestInverted >>> 0;
  const keyOf = (depth: number) =>
    shortensKeys
      ? shortDepthKey(depth, farthest, nearest, frame.accuracy.sortKeyBits)
      : depthKey(depth, farthest);
  // Far first: the most distant place has the least key.
  let expected = (await sortDepths(frame)).map(
    ({ least, most }): KeyBounds => ({ least: keyOf(most), most: keyOf(least) }),
  );
  const flaws: (string | null)[] = [];
  // With more than one pass, the keys are overwritten while they are sorted.
  if (passes === 1) {
    const keys = await frame.sorted('keys');
    const at = expected.findIndex(({ least, most }, i) => !(least <= keys[i] && keys[i] <= most));
    if (at >= 0) flaws.push(`key of visible splat ${at}: got ${keys[at]}, expected ${named(expected[at])}`);
    expected = Array.from(keys, (key) => ({ least: key, most: key }));
  }
  const sortedBits = Math.min(32, passes * digitBits);
  const order = await frame.sorted('order');
  const flaw = orderFlaw(
    expected.map(({ least, most }) => ({ least: least % 2 ** sortedBits, most: most % 2 ** sortedBits })),
    order,
  );
  flaws.push(flaw);
  return flaws;
}

/**
 * Describes the first flaw of `order`; null if it names every key once, in ascending order, equal
 * keys in given order. Where keys are known within bounds, null if that is possible.
 */
export function orderFlaw(keys: ArrayLike<number> | readonly KeyBounds[], order: Uint32Array): string | null {
  if (order.length !== keys.length) return `${order.length} places for ${keys.length} keys`;
  // One at a time: an object of bounds for each of millions of keys would fill the heap.
  const boundsOf = (index: number): KeyBounds => {
    const key = keys[index];
    return typeof key === 'number' ? { least: key, most: key } : key;
  };
  const seen = new Uint8Array(keys.length);
  /** Earlier position whose lower key bound is the largest; of equal bounds the last. */
  let last = -1;
  for (const [place, index] of order.entries()) {
    if (index >= keys.length || seen[index])
      return `order: place ${place} holds ${index}, which is out of range or a duplicate`;
    seen[index] = 1;
    const key = boundsOf(index);
    const before = order[last];
    const { least, most } = last < 0 ? NO_KEY : boundsOf(before);
    const isSure = key.least === key.most;
    const isSame = isSure && least === most && least === key.least;
    if (key.most < least || (isSame && index < before))
      return `order: place ${last} holds key ${named(boundsOf(before))} (of ${before}), place ${place} holds ${named(key)} (of ${index})`;
    if (key.least > least || (key.least === least && isSure)) last = place;
  }
  return null;
}

const NO_KEY: KeyBounds = { least: -1, most: -1 };

function named({ least, most }: KeyBounds): string {
  return least === most ? String(least) : `${least} to ${most}`;
}
