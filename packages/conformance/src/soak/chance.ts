import { seededRandom } from '../make-splats.ts';

/** Random choices, the same for the same seed on every machine. */
export class Chance {
  readonly #random: () => number;

  constructor(seed: number) {
    this.#random = seededRandom(seed);
  }

  within(low: number, high: number): number {
    return low + (high - low) * this.#random();
  }

  /** A whole number from `low` to `high`, both possible. */
  whole(low: number, high: number): number {
    return Math.floor(this.within(low, high + 1));
  }

  happens(probability: number): boolean {
    return this.#random() < probability;
  }

  of<Item>(items: readonly Item[]): Item {
    return items[this.whole(0, items.length - 1)];
  }

  /** One of `items`, each as likely as its weight is large. */
  weighted<Item extends { readonly weight: number }>(items: readonly Item[]): Item {
    const total = items.reduce((sum, { weight }) => sum + weight, 0);
    let left = this.within(0, total);
    for (const item of items) {
      left -= item.weight;
      if (left < 0) return item;
    }
    return items[items.length - 1];
  }

  /** Three numbers in ±`reach`. */
  vector(reach: number): [number, number, number] {
    return [this.within(-reach, reach), this.within(-reach, reach), this.within(-reach, reach)];
  }
}
