/**
 * Calls `each` for all items in order, so many at once, until one call fails.
 *
 * Rejects as the first that fails, when none runs any more.
 *
 * @param each its signal is aborted then.
 */
export async function inLanes<Item>(
  lanes: number,
  items: readonly Item[],
  each: (item: Item, signal: AbortSignal) => Promise<void>,
): Promise<void> {
  const failures: unknown[] = [];
  const stop = new AbortController();
  const left = items.values();
  const lane = async () => {
    for (const item of left) {
      if (failures.length > 0) return;
      await each(item, stop.signal).catch((error) => {
        failures.push(error);
        stop.abort();
      });
    }
  };
  await Promise.all(Array.from({ length: lanes }, lane));
  if (failures.length > 0) throw failures[0];
}
