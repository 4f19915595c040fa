import { type DropReason, encodePly, type SplatSet } from '@websplatter/core';
import type { HardCase, RefusedFileCase } from '../hard-case.ts';
import { amongOrdinary, frontOnly, scenesOf } from '../make-cases.ts';
import { logitOf, ordinarySplats, randomShRest, type SplatValues, splatsOf } from '../make-splats.ts';
import { type PlyPatch, patchedPly } from '../patch-ply.ts';

const scene = scenesOf('input');

/** The splat that gets a bad value: large, in front of everything, and in a colour of its own. */
const HARD: SplatValues = {
  position: [0.2, -0.1, 1.6],
  logScales: [-0.4, -0.8, -1],
  rotation: [0.9, 0.2, -0.1, 0.3],
  opacityLogit: logitOf(0.8),
  color: [1, 0.1, 0.9],
  shRest: randomShRest(1, 0.1, 3),
};

/** A set of degree 1 whose last splat is `hard`. */
const withLast = (hard: SplatValues): SplatSet => splatsOf([...ordinarySplats(), hard], { shDegree: 1 });

/** The file of `withLast(HARD)` with some values of its last row replaced. */
function patchedLast(patches: readonly Omit<PlyPatch, 'row'>[]): Uint8Array<ArrayBuffer> {
  const set = withLast(HARD);
  return patchedPly(
    set,
    patches.map((patch) => ({ row: set.count - 1, ...patch })),
  );
}

const REASONS: readonly { readonly reason: DropReason; readonly properties: readonly string[] }[] = [
  { reason: 'non-finite-position', properties: ['x', 'y', 'z'] },
  { reason: 'non-finite-scale', properties: ['scale_0', 'scale_1', 'scale_2'] },
  { reason: 'non-finite-rotation', properties: ['rot_0', 'rot_1', 'rot_2', 'rot_3'] },
  { reason: 'non-finite-opacity', properties: ['opacity'] },
  // The first and the last of the nine coefficients above degree 0.
  { reason: 'non-finite-color', properties: ['f_dc_0', 'f_dc_1', 'f_dc_2', 'f_rest_0', 'f_rest_8'] },
];

const NON_FINITE: readonly (readonly [label: string, value: number])[] = [
  ['nan', Number.NaN],
  ['plus-infinity', Number.POSITIVE_INFINITY],
  ['minus-infinity', Number.NEGATIVE_INFINITY],
];

const nonFinite = REASONS.flatMap(({ reason, properties }) =>
  properties.flatMap((property) =>
    NON_FINITE.map(([label, value]) => {
      // Allowed infinities: a logit of ±∞ is an opacity of exactly 0 or 1, a log scale of −∞ a flat splat.
      const isLogit = property === 'opacity' && !Number.isNaN(value);
      const isFlat = property.startsWith('scale_') && value === Number.NEGATIVE_INFINITY;
      return scene({
        name: `input-${label}-${property.replaceAll('_', '-')}`,
        breaks: isLogit
          ? 'An infinite logit is dropped as not finite though it is an opacity like any other.'
          : isFlat
            ? 'A splat whose log scale is −∞ is dropped though it is flat, or makes NaN of its covariance.'
            : `A value that is not finite in ${property} is uploaded, and spreads to bounds, keys or pixels.`,
        clouds: () => [{ file: patchedLast([{ property, value }]) }],
        cameras: frontOnly,
        dropped: isLogit || isFlat ? {} : { [reason]: 1 },
      });
    }),
  ),
);

/** All properties of a file of degree 1. */
const ALL_PROPERTIES = [
  ...['x', 'y', 'z', 'opacity'],
  ...[0, 1, 2].flatMap((i) => [`scale_${i}`, `f_dc_${i}`]),
  ...[0, 1, 2, 3].map((i) => `rot_${i}`),
  ...Array.from({ length: 9 }, (_, i) => `f_rest_${i}`),
];
const allOf = (value: number) => ALL_PROPERTIES.map((property) => ({ property, value }));

const DENORMAL = 2 ** -140;

const refused = (
  name: string,
  code: string,
  breaks: string,
  file: RefusedFileCase['file'],
): RefusedFileCase => ({
  kind: 'refused-file',
  group: 'input',
  name,
  code,
  breaks,
  file,
});

const text = (lines: readonly string[]) => new TextEncoder().encode(`${lines.join('\n')}\n`);

export const INPUT_CASES: readonly HardCase[] = [
  ...nonFinite,
  scene({
    name: 'input-half-of-all-rows-nan',
    breaks: 'Rows are dropped in place, and what is kept no longer lines up with its other properties.',
    clouds: () => {
      const ordinary = ordinarySplats();
      const splats = ordinary.flatMap((splat) => [HARD, splat]);
      const patches = ordinary.map((_, i) => ({
        row: 2 * i,
        property: ALL_PROPERTIES[i % ALL_PROPERTIES.length],
        value: Number.NaN,
      }));
      return [{ file: patchedPly(splatsOf(splats, { shDegree: 1 }), patches) }];
    },
    cameras: frontOnly,
    dropped: droppedByProperty(ordinarySplats().map((_, i) => ALL_PROPERTIES[i % ALL_PROPERTIES.length])),
  }),
  scene({
    name: 'input-double-beyond-float32',
    breaks: 'A finite double becomes Inf when it is rounded to float32, after it was checked.',
    clouds: () => {
      // An origin makes encodePly write doubles.
      const set = splatsOf([...ordinarySplats(), HARD], { origin: [2 ** -10, 0, 0] });
      return [{ file: patchedPly(set, [{ row: set.count - 1, property: 'x', value: 1e39 }]) }];
    },
    cameras: frontOnly,
    dropped: { 'non-finite-position': 1 },
  }),
  scene({
    name: 'input-position-3e38',
    breaks: 'The largest floats are finite in the file but overflow in bounds, products and differences.',
    clouds: () => [
      {
        file: patchedLast([
          { property: 'x', value: 3e38 },
          { property: 'y', value: -3e38 },
        ]),
      },
    ],
    dropped: {},
  }),
  scene({
    name: 'input-position-3e38-in-depth',
    breaks: 'The farthest possible splat takes the whole range of keys or of Morton codes for itself.',
    clouds: () => [{ file: patchedLast([{ property: 'z', value: -3e38 }]) }],
    dropped: {},
  }),
  scene({
    name: 'input-rotation-3e38',
    breaks: 'The squared length of a quaternion of the largest floats is Inf.',
    clouds: () => [
      {
        file: patchedLast([
          { property: 'rot_0', value: 3e38 },
          { property: 'rot_3', value: -3e38 },
        ]),
      },
    ],
    dropped: {},
  }),
  scene({
    name: 'input-scale-3e38',
    breaks: 'exp of any such log scale is Inf, and Inf·0 in the rotated axes NaN.',
    clouds: () => [{ file: patchedLast([{ property: 'scale_1', value: 3e38 }]) }],
    cameras: frontOnly,
    dropped: {},
  }),
  scene({
    name: 'input-denormals',
    breaks:
      'Denormals are flushed by some GPUs and not by others; comparing them with 0, or dividing by them, differs.',
    clouds: () => [{ file: patchedLast(allOf(DENORMAL)) }],
    dropped: {},
  }),
  scene({
    name: 'input-minus-zero',
    breaks: 'Bits of −0 are taken for a large unsigned number by keys, Morton codes or packing.',
    clouds: () => [{ file: patchedLast(allOf(-0)) }],
    dropped: {},
  }),
  scene({
    name: 'input-all-zero-row',
    breaks: 'Rows of zeros are taken for padding and left out, or their quaternion of length 0 makes NaN.',
    clouds: () => [{ file: patchedLast(allOf(0)) }],
    dropped: {},
  }),
  scene({
    name: 'input-all-rows-zero',
    breaks: 'A cloud of zeros has bounds of size 0, which normalising positions divides by.',
    clouds: () => {
      const set = splatsOf(
        Array.from({ length: 20 }, () => ({})),
        { shDegree: 1 },
      );
      const patches = Array.from({ length: set.count }, (_, row) =>
        allOf(0).map((patch) => ({ row, ...patch })),
      ).flat();
      return [{ file: patchedPly(set, patches) }, ...amongOrdinary([])()];
    },
    cameras: frontOnly,
    dropped: {},
    identicalFrames: 100,
  }),
  scene({
    name: 'input-duplicate-splats',
    breaks: 'Two of everything tie in every key, and their order changes from frame to frame.',
    clouds: () => {
      const twice = [...ordinarySplats(), HARD].flatMap((splat) => [
        splat,
        { ...splat, color: [0.1, 0.9, 0.3], opacityLogit: 0 },
      ]);
      return [{ file: encodePly(splatsOf(twice, { shDegree: 1 })) }];
    },
    cameras: frontOnly,
    dropped: {},
    identicalFrames: 100,
  }),
  scene({
    name: 'input-all-at-one-point',
    breaks: 'Bounds of size 0 make Morton codes or normalised positions 0/0; all depths are equal.',
    clouds: () => [
      {
        set: splatsOf(
          Array.from({ length: 100 }, (_, i) => ({
            position: [0.3, 0.2, 0.1],
            logScales: [-2 + (i % 10) / 5, -2 + (i % 7) / 5, -2],
            rotation: [1, 0, 0, i / 40],
            opacityLogit: logitOf(0.3),
            color: [(i % 5) / 4, (i % 3) / 2, (i % 2) / 1],
          })),
        ),
      },
      { set: splatsOf(ordinarySplats()) },
    ],
    cameras: frontOnly,
    identicalFrames: 100,
  }),
  refused(
    'input-0-splats',
    'empty',
    'A file without splats is loaded as an empty scene, or divides by its count.',
    () => encodePly(splatsOf([])),
  ),
  refused(
    'input-every-row-nan',
    'empty',
    'A scene whose every row was dropped appears as an empty image without a word.',
    () => {
      const set = splatsOf([HARD, HARD]);
      return patchedPly(set, [
        { row: 0, property: 'x', value: Number.NaN },
        { row: 1, property: 'scale_2', value: Number.POSITIVE_INFINITY },
      ]);
    },
  ),
  refused(
    'input-truncated',
    'truncated',
    'The rows that are missing are read as zeros, or as what was in memory.',
    () => encodePly(withLast(HARD)).slice(0, -5),
  ),
  refused('input-no-rotation', 'not-splats', 'A point cloud is drawn as splats of no size.', () =>
    text([
      ...['ply', 'format ascii 1.0', 'element vertex 1'],
      ...['x', 'y', 'z'].map((name) => `property float ${name}`),
      ...['end_header', '1 2 3'],
    ]),
  ),
  refused('input-no-ply', 'unknown-format', 'Bytes of any other kind are read as if they were splats.', () =>
    text(['not', 'splats', 'at', 'all']),
  ),
];

/** Counts, by reason, the rows that are dropped if each row has NaN in one of these properties. */
function droppedByProperty(properties: readonly string[]): Partial<Record<DropReason, number>> {
  const counts: Partial<Record<DropReason, number>> = {};
  for (const property of properties) {
    const stem = property.replace(/_\d+$/, '');
    const { reason } = REASONS.find((entry) =>
      entry.properties.some((name) => name.replace(/_\d+$/, '') === stem),
    )!;
    counts[reason] = (counts[reason] ?? 0) + 1;
  }
  return counts;
}
