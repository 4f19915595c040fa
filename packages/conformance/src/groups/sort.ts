import type { HardCase, SortCase } from '../hard-case.ts';
import { seededRandom } from '../make-splats.ts';

type KeyBits = SortCase['keyBits'];

const WIDTHS: readonly KeyBits[] = [16, 24, 27, 32];

/** Keys per block of the sort, by the device's workgroup memory and the digits. */
const BLOCK_KEYS = [3072, 4096, 4608];
/** At least two full blocks and part of another. */
const COUNT = 2 * 4608 + 77;

interface Pattern {
  readonly name: string;
  readonly breaks: string;
  /** Key `i` of `count`, in [0, 1). */
  readonly at: (count: number) => (i: number, keyBits: KeyBits) => number;
}

const PATTERNS: readonly Pattern[] = [
  {
    name: 'sorted',
    breaks: 'Sorted keys put a whole block into one digit, whose counter overflows its type.',
    at: (count) => (i) => i / count,
  },
  {
    name: 'reversed',
    breaks: 'Reversed keys make every exchange necessary: a sort of too few passes leaves some undone.',
    at: (count) => (i) => (count - 1 - i) / count,
  },
  {
    name: 'all-equal',
    breaks: 'Equal keys must keep their order, which atomics within a block do not.',
    at: () => (_, keyBits) => 1 - 2 ** -keyBits,
  },
  {
    name: 'one-differs',
    breaks: 'A single smaller key moves all others by one, across the borders of blocks.',
    at: (count) => (i, keyBits) => (i === count >> 1 ? 0 : 1 - 2 ** -keyBits),
  },
  {
    name: 'sawtooth',
    breaks: 'A period that is no divisor of the block puts runs of one key on both sides of every border.',
    at: () => (i, keyBits) => (i % 200) / 2 ** keyBits,
  },
  {
    name: 'only-the-top-digit-differs',
    breaks: 'A last pass that takes too few bits, or shifts by the wrong number, sorts nothing.',
    at: () => (i, keyBits) => (((i * 2654435761) % 256) * 2 ** (keyBits - 8) + 5) / 2 ** keyBits,
  },
  {
    name: 'few-distinct',
    breaks: 'Long runs of equal keys, mixed with others, show whether every pass is stable.',
    at: () => {
      const random = seededRandom(5);
      return () => Math.floor(random() * 3) / 3;
    },
  },
  {
    name: 'random',
    breaks: 'Any pass that loses or repeats a key breaks the permutation.',
    at: (count) => {
      const random = seededRandom(count);
      return () => random();
    },
  },
];

function sortCase(
  name: string,
  { breaks, at }: Pattern,
  keyBits: KeyBits,
  count: number,
  maxWorkgroupsPerDimension?: number,
): SortCase {
  return {
    kind: 'sort',
    group: 'sort',
    name,
    breaks,
    keys: () => {
      const keyAt = at(count);
      return Uint32Array.from({ length: count }, (_, i) => Math.floor(keyAt(i, keyBits) * 2 ** keyBits));
    },
    keyBits,
    maxWorkgroupsPerDimension,
  };
}

const RANDOM = PATTERNS[PATTERNS.length - 1];
const counted = (breaks: string): Pattern => ({ ...RANDOM, breaks });

/** Numbers of keys about seven blocks, a row of them, and in several rows. */
const ROW_COUNTS = [...BLOCK_KEYS.flatMap((keys) => [7 * keys - 1, 7 * keys, 7 * keys + 1]), 50 * 3072 + 3];

export const SORT_CASES: readonly HardCase[] = [
  ...WIDTHS.flatMap((keyBits) =>
    PATTERNS.map((pattern) => sortCase(`sort-${pattern.name}-${keyBits}-bits`, pattern, keyBits, COUNT)),
  ),
  ...[0, 1, 2].map((count) =>
    sortCase(
      `sort-${count}-keys`,
      counted('A sort of almost nothing reads what is behind its keys.'),
      32,
      count,
    ),
  ),
  ...BLOCK_KEYS.flatMap((keys) => [keys - 1, keys, keys + 1]).map((count) =>
    sortCase(
      `sort-${count}-keys`,
      counted('A block that is full, or holds one key, is counted wrongly.'),
      32,
      count,
    ),
  ),
  ...ROW_COUNTS.map((count) =>
    sortCase(
      `sort-${count}-keys-in-rows-of-7`,
      counted('Blocks beyond the first row of a dispatch are left out or done twice.'),
      27,
      count,
      7,
    ),
  ),
];
