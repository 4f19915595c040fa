import { InvalidArgumentError } from '../../data/errors.ts';
import type { DispatchContext } from '../ingest/dispatches.ts';

/** Default of the GPU memory that streamed scenes share. */
const DEFAULT_STREAM_BYTES = 512 << 20;

/** Bytes that a scene can use: `leastBytes` for its coarsest part, `mostBytes` for all of it. */
export interface StreamNeed {
  readonly name: string;
  readonly leastBytes: number;
  readonly mostBytes: number;
}

/** A scene with a share of the engine's budget. */
interface Sharer extends StreamNeed {
  /** Size of its share. */
  bytes: number;
  /** Changes its size to at most this many bytes; never fails. Null while the scene is opened. */
  resize: ((bytes: number) => Promise<void>) | null;
}

/** The streamed scenes of an engine without budgets of their own. */
export interface StreamShares {
  /** GPU memory for all of these scenes together, bytes. Default: 512 MiB. */
  readonly budgetBytes?: number;
  readonly sharers: Set<Sharer>;
  /** Settles when no share changes; changes are sequential. Never rejects. */
  turn: Promise<unknown>;
}

/** The services of an engine that streamed scenes need. */
export interface StreamContext extends DispatchContext {
  readonly shares: StreamShares;
}

export interface StreamOptions {
  /**
   * Limit of the scene's GPU memory, bytes. Default: a share of the engine's `streamBudgetBytes`.
   */
  readonly budgetBytes?: number;
  readonly signal?: AbortSignal;
}

/** @throws InvalidArgumentError if the scene's own budget does not hold its coarsest part. */
export function checkBudget({ name, leastBytes }: StreamNeed, { budgetBytes }: StreamOptions): void {
  if (budgetBytes === undefined || budgetBytes >= leastBytes) return;
  const message = `budgetBytes is ${budgetBytes}; ${name} needs at least ${leastBytes}.`;
  throw new InvalidArgumentError('budgetBytes', message);
}

/**
 * Makes a streamed scene within its own budget, or with a share of the engine's. Other scenes
 * shrink before it is made, and grow back on `leave` or if it fails.
 *
 * @param make makes the scene from its share in bytes; returns it with a function that resizes it.
 * @throws InvalidArgumentError if the engine's budget does not hold the coarsest parts of all
 *   scenes; errors of `make`; the signal's reason.
 */
export async function withShare<Made>(
  shares: StreamShares,
  need: StreamNeed,
  { budgetBytes: ownBytes, signal }: StreamOptions,
  make: (bytes: number, leave: () => void) => Promise<{ made: Made; resize: Sharer['resize'] }>,
): Promise<Made> {
  if (ownBytes !== undefined) return (await make(ownBytes, () => {})).made;
  const { sharers, budgetBytes = DEFAULT_STREAM_BYTES } = shares;
  return inTurn(shares, async () => {
    signal?.throwIfAborted();
    const leastBytes = [...sharers, need].reduce((sum, each) => sum + each.leastBytes, 0);
    if (leastBytes > budgetBytes) {
      const all =
        sharers.size > 0 ? `${need.name} and ${sharers.size} that are there need` : `${need.name} needs`;
      const message = `streamBudgetBytes is ${budgetBytes}; ${all} at least ${leastBytes}. Create the engine with more, or load with budgetBytes.`;
      throw new InvalidArgumentError('streamBudgetBytes', message);
    }
    const sharer: Sharer = { ...need, bytes: 0, resize: null };
    const leave = () => {
      if (sharers.delete(sharer)) void inTurn(shares, () => divide(shares));
    };
    sharers.add(sharer);
    try {
      await divide(shares);
      signal?.throwIfAborted();
      const { made, resize } = await make(sharer.bytes, leave);
      sharer.resize = resize;
      return made;
    } catch (error) {
      leave();
      throw error;
    }
  });
}

function inTurn<Result>(shares: StreamShares, work: () => Promise<Result>): Promise<Result> {
  const result = shares.turn.then(work);
  // The caller gets the error; the next one takes its turn all the same.
  shares.turn = result.catch(() => {});
  return result;
}

/** Resizes all scenes to their shares: before a new scene is made, and after one has gone. */
async function divide({ sharers, budgetBytes = DEFAULT_STREAM_BYTES }: StreamShares): Promise<void> {
  const all = [...sharers];
  for (const [i, bytes] of sharesOf(all, budgetBytes).entries()) {
    const sharer = all[i];
    if (sharer.bytes === bytes || !sharers.has(sharer)) continue;
    sharer.bytes = bytes;
    await sharer.resize?.(bytes);
  }
}

/**
 * Equal shares of a budget, clamped to each scene's `leastBytes` and `mostBytes`. The other scenes
 * share the difference.
 */
export function sharesOf(needs: readonly StreamNeed[], budgetBytes: number): number[] {
  const at = (level: number) =>
    needs.map(({ leastBytes, mostBytes }) => Math.min(mostBytes, Math.max(leastBytes, level)));
  // Bisects for the largest equal share that the budget holds, to a byte.
  let [low, high] = [0, budgetBytes + 1];
  while (high - low > 1) {
    const level = Math.floor((low + high) / 2);
    if (at(level).reduce((sum, share) => sum + share, 0) <= budgetBytes) low = level;
    else high = level;
  }
  return at(low);
}
