/** Reference of sort-gather: the upper words of keys, in the order that `payloads` lists. */
export function sortGather(upperKeys: ArrayLike<number>, payloads: Uint32Array): Uint32Array {
  return payloads.map((index) => upperKeys[index]);
}
