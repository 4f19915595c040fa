import { InvalidArgumentError } from '../data/errors.ts';
import type { DispatchContext } from './ingest/dispatches.ts';

/** GPU memory that streamed scenes share where nothing else is asked for. */
const DEFAULT_STREAM_BYTES = 512 << 20;

/** The bytes that a scene can use: for its coarsest part, and for all of it. */
export interface StreamNeed {
  readonly name: string;
  readonly leastBytes: number;
  readonly mostBytes: number;
}

/** A scene that shares the budget. */
interface Sharer extends StreamNeed {
  /** Bytes that it may take. */
  bytes: number;
  /** Takes more or fewer bytes, at most so many; does not fail. Null while the scene is opened. */
  resize: ((bytes: number) => Promise<void>) | null;
}

/** The streamed scenes of an engine that have no budget of their own. */
export interface StreamShares {
  /** GPU memory for all of them together; default 512 MiB. */
  readonly budgetBytes?: number;
  readonly sharers: Set<Sharer>;
  /** Settles when shares rest; they change one after the other. Never rejects. */
  turn: Promise<unknown>;
}

/** The parts of an engine that show scenes of which parts are there. */
export interface StreamContext extends DispatchContext {
  readonly shares: StreamShares;
}

export interface StreamOptions {
  /** GPU memory of the scene's own, at most; default a share of the engine's. */
  readonly budgetBytes?: number;
  readonly signal?: AbortSignal;
}

/** @throws InvalidArgumentError if a budget of its own does not hold the coarsest part of a scene. */
export function checkBudget({ name, leastBytes }: StreamNeed, { budgetBytes }: StreamOptions): void {
  if (budgetBytes === undefined || budgetBytes >= leastBytes) return;
  const message = `budgetBytes is ${budgetBytes}; ${name} needs at least ${leastBytes}.`;
  throw new InvalidArgumentError('budgetBytes', message);
}

/**
 * Makes a streamed scene within its own budget, or with a share of the engine's. Other scenes make
 * room for that before, and get it back by `leave`, or if this fails.
 *
 * @param make is given the bytes, and returns the scene with the function that changes them.
 * @throws InvalidArgumentError if the engine's budget does not hold the coarsest parts of all
 *   scenes; what `make` throws; the signal's reason.
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
  shares.turn = result.catch(() => {});
  return result;
}

/** Gives each scene its share: all shrink as one comes, before it takes any, and grow as one goes. */
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
 * Equal shares of a budget, but to none less than it needs at least, nor more than it needs at
 * most; the rest is for the others.
 */
export function sharesOf(needs: readonly StreamNeed[], budgetBytes: number): number[] {
  const at = (level: number) =>
    needs.map(({ leastBytes, mostBytes }) => Math.min(mostBytes, Math.max(leastBytes, level)));
  // The highest level that the budget holds, to a byte.
  let [low, high] = [0, budgetBytes + 1];
  while (high - low > 1) {
    const level = Math.floor((low + high) / 2);
    if (at(level).reduce((sum, share) => sum + share, 0) <= budgetBytes) low = level;
    else high = level;
  }
  return at(low);
}
