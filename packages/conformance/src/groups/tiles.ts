import type { HardCase } from '../hard-case.ts';
import { amongOrdinary, atOrigin, frontOnly, scenesOf } from '../make-cases.ts';
import { logitOf, moved, ordinarySplats, type SplatValues, seededRandom, splatsOf } from '../make-splats.ts';

const scene = scenesOf('tiles');

/** Compute renderers list splats by tiles of 8 to 64 px: images have several of the largest. */
const SIZE = { widthPx: 200, heightPx: 136 };

const NEEDLES = 24;
/** Needles at every angle, longer than the image and less than a pixel wide. */
const needles = (): SplatValues[] =>
  Array.from({ length: NEEDLES }, (_, i) => {
    const angle = (Math.PI * (i + 0.3)) / NEEDLES;
    return {
      position: [0.7 * Math.sin(5 * i), 0.5 * Math.cos(3 * i), i / NEEDLES],
      logScales: [1, -6, -6],
      rotation: [Math.cos(angle / 2), 0, 0, Math.sin(angle / 2)],
      opacityLogit: 2,
      color: [i / NEEDLES, 1 - i / NEEDLES, 0.5],
    };
  });

/** Splats so small that each touches a tile or two, all within one of the largest tiles. */
const crowd = (): SplatValues[] => {
  const random = seededRandom(6);
  return Array.from({ length: 700 }, () => ({
    position: [-1.6 + random(), 0.6 + random(), random()],
    logScales: [-4, -4, -4],
    color: [random(), random(), random()],
  }));
};

const sheet = (z: number, alpha: number, color: readonly number[]): SplatValues => ({
  position: [0, 0, z],
  logScales: [5, 5, -5],
  // Alpha beyond 0.99 is drawn as 0.99.
  opacityLogit: alpha < 0.99 ? logitOf(alpha) : 100,
  color,
});

export const TILES_CASES: readonly HardCase[] = [
  scene({
    name: 'tiles-last-one-of-a-single-pixel',
    breaks: 'Tiles that the edge of the image cuts off are left out, or written beyond the image.',
    clouds: amongOrdinary([]),
    cameras: frontOnly,
    size: { widthPx: 129, heightPx: 65 },
  }),
  scene({
    name: 'tiles-needles-across',
    breaks:
      'The test whether an ellipse touches a tile looks at corners or the closest point, and needles get gaps.',
    clouds: amongOrdinary(needles()),
    cameras: frontOnly,
    size: SIZE,
  }),
  scene({
    name: 'tiles-crowd-in-one',
    breaks: 'Lists of limited length overflow in one tile while the others are all but empty.',
    clouds: amongOrdinary(crowd()),
    cameras: frontOnly,
    size: SIZE,
  }),
  scene({
    name: 'tiles-splats-in-all',
    breaks:
      'A splat over the whole image is listed once per tile, and what a neighbouring tile lists is drawn twice.',
    clouds: () => [
      {
        set: splatsOf([
          ...moved(ordinarySplats(), [0, 0, -6]),
          ...Array.from({ length: 45 }, (_, i) => sheet(-1 - i / 64, 0.02, [i % 2, (i >> 1) % 2, 1])),
        ]),
      },
    ],
    cameras: (aspect) => atOrigin(aspect, { near: 0.01, far: 1000 }),
    size: SIZE,
  }),
  scene({
    name: 'tiles-bright-behind-almost-opaque',
    breaks: 'Blending front to back ends at an opacity that still lets a bright splat behind shine through.',
    clouds: () => [
      {
        set: splatsOf([
          sheet(-1, 0.99, [0, 0, 0]),
          // Batches of splats that change next to nothing.
          ...Array.from({ length: 70 }, (_, i) => sheet(-2 - i / 64, 0.005, [0, 0, 0])),
          sheet(-5, 0.99, [20, 10, 5]),
        ]),
      },
    ],
    cameras: (aspect) => atOrigin(aspect, { near: 0.01, far: 1000 }),
    size: { widthPx: 16, heightPx: 16 },
  }),
];
