import { orthographicCamera, perspectiveCamera } from '@websplatter/core';
import type { HardCase, HardCloud } from '../hard-case.ts';
import { amongOrdinary, atOrigin, frontOnly, scenesOf } from '../make-cases.ts';
import { logitOf, moved, ordinarySplats, type SplatValues, seededRandom, splatsOf } from '../make-splats.ts';

const scene = scenesOf('depth');

const RED = [1, 0.05, 0.05];
const BLUE = [0.05, 0.1, 1];
const GREEN = [0.05, 0.9, 0.1];

const splat = (position: readonly number[], color: readonly number[], change: SplatValues = {}) => ({
  position,
  color,
  logScales: [-1, -1, -1],
  opacityLogit: logitOf(0.9),
  ...change,
});

/** Splats that fill the view of `atOrigin`, at depths of 4 to 9. */
const backdrop = () => moved(ordinarySplats(), [0, 0, -6]);

const NEAR_AND_FAR = { near: 0.01, far: 1000 };

/** An 8 × 8 grid of overlapping splats at depth `depth`, a dyadic number. */
const plane = (depth: number, color: (i: number) => readonly number[]): SplatValues[] =>
  Array.from({ length: 64 }, (_, i) =>
    splat([(i % 8) / 4 - 0.875, Math.floor(i / 8) / 4 - 0.875, -depth], color(i), {
      logScales: [-1.5, -1.5, -1.5],
    }),
  );

/** Colours, different for neighbours. */
const speckled = (i: number) => [(i * 7) % 11, (i * 5) % 13, (i * 3) % 7].map((v, k) => v / [10, 12, 6][k]);

/** Interleaves lists, so that file order and Morton order do not follow depth. */
function interleaved(a: readonly SplatValues[], b: readonly SplatValues[]): SplatValues[] {
  return a.flatMap((splatOfA, i) => (i % 2 === 0 ? [splatOfA, b[i]] : [b[i], splatOfA]));
}

const orthographicAtOrigin = (aspect: number, range: { readonly near: number; readonly far: number }) => ({
  orthographic: orthographicCamera({ position: [0, 0, 0], target: [0, 0, -1], aspect, height: 8, ...range }),
});

/** A cloud whose file requests sorting by distance. */
const byDistance = (splats: readonly SplatValues[], modelMatrix?: ArrayLike<number>): HardCloud => ({
  set: { ...splatsOf(splats), fileFacts: { format: 'gltf', isSortedByDistance: true } },
  modelMatrix,
});

/** A view full of large splats, many nearer by depth than others that are nearer by distance. */
const crossing = (): SplatValues[] =>
  Array.from({ length: 96 }, (_, i) => {
    const [x, y] = [((i % 12) - 5.5) / 3, (Math.floor(i / 12) - 3.5) / 3];
    return splat([x, y, -3 - ((i * 29) % 96) / 96], speckled(i), {
      logScales: [-1, -1, -1],
      opacityLogit: logitOf(0.7),
    });
  });

/** A slanted direction of looking, and the two across it. */
const SLANTED = {
  forward: [-2 / 7, -3 / 7, -6 / 7],
  right: [6 / 7, 2 / 7, -3 / 7],
  up: [-3 / 7, 6 / 7, -2 / 7],
};

const slantedAtOrigin = (aspect: number) => ({
  slanted: perspectiveCamera({
    ...{ position: [0, 0, 0], target: [-2, -3, -6], fovYDegrees: 60, aspect, ...NEAR_AND_FAR },
  }),
});

/** Opaque splats all over the view of `slantedAtOrigin`, at depths or distances that `at` gives. */
const slantedSplats = (at: (random: () => number) => number, isDistance: boolean): SplatValues[] => {
  const random = seededRandom(54);
  return Array.from({ length: 400 }, (_, i) => {
    const [right, up] = [random() - 0.5, random() - 0.5];
    const toward = SLANTED.forward.map((f, k) => f + right * SLANTED.right[k] + up * SLANTED.up[k]);
    const factor = at(random) / (isDistance ? Math.hypot(...toward) : 1);
    return splat(
      toward.map((t) => t * factor),
      speckled(i),
      {
        logScales: [-2, -2, -2],
        opacityLogit: logitOf(0.99),
      },
    );
  });
};

export const DEPTH_CASES: readonly HardCase[] = [
  scene({
    name: 'depth-all-equal',
    breaks: 'Equal keys come out of an unstable sort, or an atomic compaction, in another order every frame.',
    clouds: () => [{ set: splatsOf([...backdrop(), ...plane(2, speckled)]) }],
    cameras: (aspect) => atOrigin(aspect, NEAR_AND_FAR),
    identicalFrames: 100,
  }),
  scene({
    name: 'depth-all-equal-two-clouds',
    breaks: 'The order of equal depths depends on which cloud happens to be appended first.',
    clouds: () => [
      { set: splatsOf([...backdrop(), ...plane(2, () => RED)]) },
      { set: splatsOf(moved(plane(2, speckled), [0.125, 0.125, 0])) },
    ],
    cameras: (aspect) => atOrigin(aspect, NEAR_AND_FAR),
    identicalFrames: 100,
  }),
  scene({
    name: 'depth-planes-one-ulp-apart',
    breaks:
      'Quantised depths merge two planes that float32 still tells apart, and the far one shows through.',
    clouds: () => [
      {
        set: splatsOf([
          ...backdrop(),
          ...interleaved(
            plane(2, () => RED),
            plane(2 + 2 ** -22, () => BLUE),
          ),
        ]),
      },
    ],
    cameras: (aspect) => atOrigin(aspect, NEAR_AND_FAR),
  }),
  scene({
    name: 'depth-planes-one-ulp-apart-in-a-deep-scene',
    breaks: 'One splat far away stretches the range of depths until linear keys hold all others in one step.',
    clouds: () => [
      {
        set: splatsOf([
          ...backdrop(),
          splat([0, 0, -900], GREEN, { logScales: [4, 4, 4] }),
          ...interleaved(
            plane(2, () => BLUE),
            plane(2 - 2 ** -23, () => RED),
          ),
        ]),
      },
    ],
    cameras: (aspect) => atOrigin(aspect, NEAR_AND_FAR),
  }),
  scene({
    name: 'depth-64-layers-in-one-16-bit-step',
    breaks: 'Keys of 16 bits take 64 layers for one depth and draw them in storage order.',
    clouds: () => {
      const random = seededRandom(11);
      const layers = Array.from({ length: 64 }, (_, i) =>
        splat([random() - 0.5, random() - 0.5, -3 - i * 2 ** -20], speckled(i), {
          opacityLogit: logitOf(0.6),
        }),
      );
      const shuffled = layers.map((_, i) => layers[(i * 37) % layers.length]);
      return [{ set: splatsOf([...backdrop(), ...shuffled, splat([5, 5, -500], GREEN)]) }];
    },
    cameras: (aspect) => atOrigin(aspect, NEAR_AND_FAR),
  }),
  scene({
    name: 'depth-slab-thinner-than-a-step-of-float32',
    breaks: 'Depths that float32 takes for equal leave hundreds of opaque splats in storage order.',
    clouds: () => [{ set: splatsOf(slantedSplats((random) => 3 + 2 ** -23 * random(), false)) }],
    cameras: slantedAtOrigin,
  }),
  scene({
    name: 'depth-shell-thinner-than-a-step-of-float32',
    breaks: 'Distances that float32 takes for equal leave hundreds of opaque splats in storage order.',
    clouds: () => [byDistance(slantedSplats((random) => 3 + 2 ** -23 * random(), true))],
    cameras: slantedAtOrigin,
  }),
  scene({
    name: 'depth-lattice-from-its-corner',
    breaks: 'Depths that are equal but for the rounding of float64 come in the order of another rounding.',
    clouds: () => [
      {
        set: splatsOf(
          Array.from({ length: 512 }, (_, i) =>
            splat(
              [i % 8, (i >> 3) % 8, i >> 6].map((step) => step / 4 - 0.875),
              speckled(i),
              {
                logScales: [-1.5, -1.5, -1.5],
              },
            ),
          ),
        ),
      },
    ],
    cameras: (aspect) => ({
      corner: perspectiveCamera({ position: [3, 3, 3], target: [0, 0, 0], fovYDegrees: 50, aspect }),
    }),
  }),
  ...(
    [
      ['at-near', -1],
      ['one-ulp-beyond-near', -(1 + 2 ** -23)],
      ['one-ulp-before-near', -(1 - 2 ** -24)],
    ] as const
  ).map(([where, z]) =>
    scene({
      name: `depth-${where}`,
      breaks:
        'A near plane that is tested in clip space, where the projection has rounded it, keeps or loses the splat.',
      clouds: () => [{ set: splatsOf([...backdrop(), splat([0, 0, z], RED, { logScales: [-2, -2, -2] })]) }],
      cameras: (aspect) => atOrigin(aspect, { near: 1, far: 1000 }),
    }),
  ),
  ...(
    [
      ['at-far', -16],
      ['one-ulp-beyond-far', -(16 + 2 ** -19)],
      ['one-ulp-before-far', -(16 - 2 ** -20)],
    ] as const
  ).map(([where, z]) =>
    scene({
      name: `depth-${where}`,
      breaks:
        'A far plane that is tested in clip space, where depth has lost its bits, keeps or loses the splat.',
      // Nothing may lie in front of its middle, or it would be hidden.
      clouds: () => [
        {
          set: splatsOf([
            ...moved(ordinarySplats(), [6, 0, -6]),
            splat([-1, 0, z], RED, { logScales: [0.5, 0.5, 0.5] }),
          ]),
        },
      ],
      cameras: (aspect) => atOrigin(aspect, { near: 1, far: 16 }),
    }),
  ),
  scene({
    name: 'depth-behind-the-camera',
    breaks: 'Splats behind the eye are mirrored into the image by the division by a negative depth.',
    clouds: amongOrdinary([
      splat([0, 0, 6], RED, { logScales: [1, 1, 1] }),
      splat([0.3, 0.4, 5 + 2 ** -20], GREEN, { logScales: [2, 2, 2] }),
      splat([1, 1, 500], BLUE, { logScales: [6, 6, 6] }),
    ]),
    cameras: frontOnly,
  }),
  scene({
    name: 'depth-far-1e6-times-near',
    breaks: 'Linear keys give all but the farthest splats one depth when far is a million times near.',
    clouds: () => [
      {
        set: splatsOf(
          Array.from({ length: 60 }, (_, i) => {
            const depth = 0.0011 * 10 ** (i / 10);
            const [x, y] = [0.35 * depth * Math.cos(2.4 * i), 0.35 * depth * Math.sin(2.4 * i)];
            const logScale = Math.log(0.12 * depth);
            return splat([x, y, -depth], speckled(i), { logScales: [logScale, logScale, logScale] });
          }),
        ),
      },
    ],
    cameras: (aspect) => atOrigin(aspect, { near: 0.001, far: 1000 }),
  }),
  scene({
    name: 'depth-far-infinite',
    breaks: 'Depths that are mapped to near…far become NaN or 0 where far is infinite.',
    clouds: () => [
      {
        set: splatsOf([
          ...backdrop(),
          splat([0.3, 0.2, -2], RED),
          splat([-2e5, 1e5, -1e6], GREEN, { logScales: [12, 12, 12] }),
        ]),
      },
    ],
    cameras: (aspect) => atOrigin(aspect, { near: 0.01, far: Number.POSITIVE_INFINITY }),
  }),
  scene({
    name: 'depth-key-zero-for-all',
    breaks: 'The range of depths is 0 and normalising by it divides by 0.',
    clouds: () => [{ set: splatsOf(plane(2, speckled)) }],
    cameras: (aspect) => atOrigin(aspect, NEAR_AND_FAR),
    identicalFrames: 100,
  }),
  scene({
    name: 'depth-key-at-maximum',
    breaks:
      'Keys from one end of the range to the other wrap around, or lose bits in a sort of too few passes.',
    clouds: () => [
      {
        set: splatsOf([
          splat([0, 0, -1e30], GREEN, { logScales: [1, 1, 1] }),
          splat([1, 0.5, 1e30], RED, { logScales: [-0.5, -0.5, -0.5] }),
          splat([-1, 0.5, -(2 ** -126)], BLUE, { logScales: [0, 0, 0] }),
          splat([-1, -0.5, 2 ** -126], RED, { logScales: [-0.5, -0.5, -0.5] }),
          splat([0, 1, -1], speckled(5), { logScales: [0, 0, 0] }),
          splat([0.5, -1, 1], speckled(9), { logScales: [0, 0, 0] }),
        ]),
      },
    ],
    cameras: (aspect) => orthographicAtOrigin(aspect, { near: -2e30, far: 2e30 }),
  }),
  scene({
    name: 'depth-either-side-of-zero',
    breaks:
      'The bits of a negative float grow with its magnitude, so that what lies behind an orthographic eye is reversed.',
    clouds: () => [
      {
        set: splatsOf([
          ...ordinarySplats(),
          ...Array.from({ length: 16 }, (_, i) =>
            splat([0.2 * (i % 4), 0.2 * Math.floor(i / 4), (((i * 7) % 16) - 7.5) / 8], speckled(i)),
          ),
        ]),
      },
    ],
    cameras: (aspect) => orthographicAtOrigin(aspect, { near: -10, far: 10 }),
  }),
  scene({
    name: 'depth-negative-zero',
    breaks:
      'The bits of −0 and +0 differ though the depths are equal, which swaps splats against their storage order.',
    clouds: () => [
      {
        set: splatsOf([
          ...moved(ordinarySplats(), [0, 0, -2]),
          splat([0, 0, -0], RED, { opacityLogit: logitOf(0.7) }),
          splat([0, 0, 0], GREEN, { opacityLogit: logitOf(0.7) }),
          splat([0, 0, -0], BLUE, { opacityLogit: logitOf(0.5) }),
        ]),
      },
    ],
    cameras: (aspect) => orthographicAtOrigin(aspect, { near: -10, far: 10 }),
    identicalFrames: 100,
  }),
  scene({
    name: 'depth-equal-distances',
    breaks:
      'Distances are rounded otherwise on one side of the image than on the other, and ties lose their storage order.',
    clouds: () => [
      byDistance([
        ...backdrop(),
        // Four of each distance, at a rectangle's corners: the same numbers are squared and added.
        ...Array.from({ length: 32 }, (_, i) => {
          const k = i >> 2;
          const [x, y] = [(0.25 + k / 16) * (i & 1 ? 1 : -1), (0.5 - k / 32) * (i & 2 ? 1 : -1)];
          return splat([x, y, -2 - ((5 * k) % 8) / 64], speckled(i), { opacityLogit: logitOf(0.6) });
        }),
      ]),
    ],
    cameras: (aspect) => atOrigin(aspect, NEAR_AND_FAR),
  }),
  ...(
    [
      ['depth-order-of-distances', 1],
      ['depth-order-of-distances-of-1e20', 2 ** 66],
      ['depth-order-of-distances-of-1e-20', 2 ** -66],
    ] as const
  ).map(([name, size]) =>
    scene({
      name,
      breaks: 'The squares of coordinates leave the range of float32, and all distances are infinite, or 0.',
      clouds: () => [byDistance(crossing(), [size, 0, 0, 0, 0, size, 0, 0, 0, 0, size, 0, 0, 0, 0, 1])],
      cameras: (aspect) => atOrigin(aspect, { near: 0.01 * size, far: Number.POSITIVE_INFINITY }),
    }),
  ),
  scene({
    name: 'depth-order-of-distances-of-two-clouds',
    breaks: 'Clouds are sorted each by what its own file asks for, and no longer with one another.',
    clouds: () => [
      byDistance(crossing().filter((_, i) => i % 2 === 0)),
      { set: splatsOf(crossing().filter((_, i) => i % 2 === 1)) },
    ],
    cameras: (aspect) => ({
      ...atOrigin(aspect, NEAR_AND_FAR),
      ...orthographicAtOrigin(aspect, NEAR_AND_FAR),
    }),
  }),
];
