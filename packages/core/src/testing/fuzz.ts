import { seededRandom } from './seeded-random.ts';

/** Random choices of one run. */
export class Choices {
  /** In [0, 1). */
  readonly next: () => number;

  constructor(seed: number) {
    this.next = seededRandom(seed);
  }

  /** A whole number from 0 to below `end`. */
  below(end: number): number {
    return Math.floor(this.next() * end);
  }

  isTrue(probability: number): boolean {
    return this.next() < probability;
  }

  of<Value>(values: readonly Value[]): Value {
    return values[this.below(values.length)];
  }
}

/** Runs in `npm test`, and in `npm run test:full`. */
interface Runs {
  readonly few: number;
  readonly many: number;
}

/** The full run ends many runs after this time: a slow machine tries fewer of them, but not less than the few. */
const MOST_MS = 30_000;

/**
 * Calls `run` again and again, each time with other choices. The first seed is 1, or
 * WEBSPLATTER_SEED; each further run has the next. A failure names its own seed: with that as
 * WEBSPLATTER_SEED, the first run fails.
 */
export async function fuzz(runs: Runs, run: (choices: Choices) => Promise<void> | void): Promise<void> {
  const firstSeed = Number(process.env.WEBSPLATTER_SEED ?? 1);
  const count = process.env.WEBSPLATTER_FULL ? runs.many : runs.few;
  const endMs = performance.now() + MOST_MS;
  for (let seed = firstSeed; seed < firstSeed + count; seed++) {
    if (seed >= firstSeed + runs.few && performance.now() > endMs) break;
    try {
      await run(new Choices(seed));
    } catch (cause) {
      const why = cause instanceof Error ? cause.message : String(cause);
      throw new Error(`WEBSPLATTER_SEED=${seed} fails: ${why}`, { cause });
    }
  }
}
