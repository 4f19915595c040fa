import { coefficientsPerSplat, type HarmonicsPalette, type ShDegree, type SplatSet } from '@websplatter/core';
import type { HardCase } from '../hard-case.ts';
import { frontOnly, scenesOf } from '../make-cases.ts';
import {
  logitOf,
  moved,
  ordinarySplats,
  randomShRest,
  type SplatValues,
  splatsOf,
  withRandomSh,
} from '../make-splats.ts';

const scene = scenesOf('palette');

const HARD: SplatValues = {
  position: [0.2, -0.1, 1.7],
  logScales: [-0.6, -0.8, -0.9],
  opacityLogit: logitOf(0.85),
};

/** `splats` with the palette `entries`, each of 3K coefficients; `indexOf` is a splat's entry. */
function withPalette(
  splats: readonly SplatValues[],
  degree: ShDegree,
  entries: readonly (readonly number[])[],
  indexOf: (splat: number) => number,
): SplatSet<HarmonicsPalette> {
  const width = coefficientsPerSplat(degree);
  const values = new Float32Array(entries.length * width);
  for (const [i, entry] of entries.entries()) values.set(entry, i * width);
  const indices = Uint16Array.from(splats, (_, i) => indexOf(i));
  return { ...splatsOf(splats), harmonics: { degree, entries: values, indices } };
}

/** Random entries in ±`amplitude`. */
const randomEntries = (count: number, degree: ShDegree, amplitude: number) =>
  Array.from({ length: count }, (_, i) => randomShRest(degree, amplitude, i + 1));

const SPLATS = [...ordinarySplats(), HARD];

export const PALETTE_CASES: readonly HardCase[] = [
  ...([1, 2, 3] as const).map((degree) =>
    scene({
      name: `palette-degree-${degree}`,
      breaks:
        'Entries are taken to be as long as those of degree 3, or padded to whole vectors, so that all but the first are made of others.',
      clouds: () => [
        { set: withPalette(SPLATS, degree, randomEntries(20, degree, 0.5), (i) => (7 * i) % 20) },
      ],
    }),
  ),
  scene({
    name: 'palette-of-one-entry',
    breaks:
      'The only entry has number 0: a reader that divides by the largest number, or takes 0 for none, finds nothing.',
    clouds: () => [{ set: withPalette(SPLATS, 3, randomEntries(1, 3, 0.5), () => 0) }],
  }),
  scene({
    name: 'palette-of-65536-entries',
    breaks:
      'Numbers from 32,768 on are taken for negative ones, or that of the last of an odd number of splats is cut off with its word.',
    clouds: () => [
      {
        // An odd number of splats; the last splat has the last entry.
        set: withPalette(SPLATS, 1, randomEntries(2 ** 16, 1, 0.5), (i) =>
          i % 2 === 0 ? 2 ** 16 - 1 - 3 * (SPLATS.length - 1 - i) : 2 ** 15 - 40 + i,
        ),
      },
    ],
  }),
  scene({
    name: 'palette-of-more-entries-than-splats',
    breaks:
      'Memory for entries follows the number of splats, or entries that no splat has count in what is known of the scene.',
    clouds: () => {
      const entries = randomEntries(1000, 3, 0.4).map((entry, i) =>
        i % 12 === 5 ? entry : entry.map((value) => 1e4 * value),
      );
      return [{ set: withPalette(SPLATS, 3, entries, (i) => 12 * i + 5) }];
    },
  }),
  scene({
    name: 'palette-entries-beyond-halves',
    breaks:
      'Entries in half precision or in bytes: 70,000 becomes infinite or stays at 65,504, 1e-7 becomes 0, and small ones beside a large one vanish.',
    clouds: () => {
      const small = randomShRest(3, 0.4, 3);
      const entries = [
        ...randomEntries(4, 3, 0.4),
        // Without effect on the image: the first basis function of degree 1 is 0 where y is.
        small.map((value, i) => (i < 3 ? 300 : value)),
        small.map((value, i) => (i < 3 ? 65_504 : value)),
        small.map((value, i) => (i < 3 ? -70_000 : value)),
        small.map((_, i) => (i % 2 === 0 ? 1e-7 : -6e-8)),
        randomShRest(3, 1e4, 21),
      ];
      const level = [-1.5, -0.5, 0.5, 1.5].map((x) => ({ ...HARD, position: [x, 0, 1.7 + 0.1 * x] }));
      const splats = [...ordinarySplats(), ...level, { ...HARD, position: [0.2, 1.4, 1.2] }];
      const first = splats.length - 5;
      return [{ set: withPalette(splats, 3, entries, (i) => (i < first ? i % 4 : 4 + i - first)) }];
    },
    cameras: frontOnly,
  }),
  scene({
    name: 'palette-beside-rows',
    breaks:
      'Shader, stride or binding of one cloud are used for the other, of which one has entries and the other its own coefficients.',
    clouds: () => [
      { set: withPalette(SPLATS, 3, randomEntries(20, 3, 0.5), (i) => (7 * i) % 20) },
      {
        set: splatsOf(withRandomSh(moved(ordinarySplats(2), [0.3, 0.2, 0.4]), 3, 0.5), { shDegree: 3 }),
      },
      { set: withPalette(moved([HARD], [-0.8, 0.6, 0.1]), 2, randomEntries(3, 2, 0.5), () => 2) },
    ],
  }),
];
