import { perspectiveCamera, type ShDegree } from '@websplatter/core';
import type { HardCase } from '../hard-case.ts';
import { amongOrdinary, atOrigin, frontOnly, scenesOf } from '../make-cases.ts';
import {
  logitOf,
  moved,
  ordinarySplats,
  randomShRest,
  type SplatValues,
  splatsOf,
  withRandomSh,
} from '../make-splats.ts';

const scene = scenesOf('colour');

const HARD: SplatValues = {
  position: [0.2, -0.1, 1.7],
  logScales: [-0.6, -0.8, -0.9],
  opacityLogit: logitOf(0.85),
};

/** Index of each degree's first coefficient, counted without degree 0. */
const FIRST_OF_DEGREE = [0, 0, 3, 8];

/** Coefficients of `degree` only. */
const shOfDegreeAlone = (degree: ShDegree, amplitude: number, seed: number) =>
  randomShRest(degree, amplitude, seed).map((value, i) => (i < 3 * FIRST_OF_DEGREE[degree] ? 0 : value));

const alongAxis = (aspect: number, axis: number, sign: number) => {
  const position: [number, number, number] = [0, 0, 0];
  position[axis] = 5 * sign;
  const up = axis === 1 ? ([0, 0, 1] as const) : ([0, 1, 0] as const);
  return perspectiveCamera({ position, target: [0, 0, 0], up, fovYDegrees: 60, aspect });
};

export const COLOUR_CASES: readonly HardCase[] = [
  ...([0, 1, 2, 3] as const).map((degree) =>
    scene({
      name: `colour-degree-${degree}-alone`,
      breaks:
        'A sign, a factor or the order of the basis functions of this degree differs from that of training.',
      clouds: () => {
        const splats = [...ordinarySplats(), HARD].map((splat, i) => ({
          ...splat,
          shRest: shOfDegreeAlone(degree, 0.6, i + 1),
        }));
        return [{ set: splatsOf(splats, { shDegree: degree }) }];
      },
    }),
  ),
  scene({
    name: 'colour-coefficients-of-1e4',
    breaks:
      'Colours of thousands overflow a fixed point or half-precision record, and Inf·0 makes NaN of it.',
    clouds: () => {
      const shRest = randomShRest(3, 1e4, 21);
      return [
        { set: splatsOf([...withRandomSh(ordinarySplats(), 3, 0.2), { ...HARD, shRest }], { shDegree: 3 }) },
      ];
    },
  }),
  scene({
    name: 'colour-base-of-1e4',
    breaks: 'A base colour of thousands overflows a record of half precision once it is multiplied out.',
    clouds: amongOrdinary([{ ...HARD, color: [2e4, -2e4, 0.5] }]),
  }),
  scene({
    name: 'colour-base-of-1e37',
    breaks:
      'A finite coefficient becomes Inf in a half-precision record or target, and NaN when it is blended.',
    clouds: amongOrdinary([{ ...HARD, color: [1e37, 0.2, 0.2] }]),
  }),
  scene({
    name: 'colour-negative',
    breaks:
      'A negative colour darkens what is behind it, or becomes NaN in a later power and leaves a black blob.',
    clouds: amongOrdinary([
      { ...HARD, color: [-3, 0.4, -0.5], opacityLogit: logitOf(0.5) },
      { ...HARD, position: [-0.9, 0.5, 1.6], color: [-5, -5, -5], opacityLogit: logitOf(0.5) },
    ]),
  }),
  scene({
    name: 'colour-negative-from-degree-3',
    breaks: 'Clamping each degree by itself, or only the base, gives another colour than clamping the sum.',
    clouds: () => {
      const splats = withRandomSh([...ordinarySplats(), HARD], 3, 1.5);
      return [{ set: splatsOf(splats, { shDegree: 3 }) }];
    },
  }),
  scene({
    name: 'colour-above-one',
    breaks:
      'Colours are clamped at 1 before they are blended, or the image is normalised to its brightest pixel.',
    clouds: amongOrdinary([{ ...HARD, color: [4, 2.5, 1.5], opacityLogit: logitOf(0.3) }]),
  }),
  scene({
    name: 'colour-direction-along-an-axis',
    breaks: 'Angles by atan2 or acos are undefined, or just out of range, along an axis.',
    clouds: () => [
      {
        set: splatsOf(
          [
            { ...HARD, position: [0, 0, 0], shRest: randomShRest(3, 0.7, 5) },
            ...withRandomSh(ordinarySplats(), 3, 0.3),
          ],
          {
            shDegree: 3,
          },
        ),
      },
    ],
    cameras: (aspect) => ({
      'from-plus-x': alongAxis(aspect, 0, 1),
      'from-minus-x': alongAxis(aspect, 0, -1),
      'from-plus-y': alongAxis(aspect, 1, 1),
      'from-minus-y': alongAxis(aspect, 1, -1),
      'from-plus-z': alongAxis(aspect, 2, 1),
      'from-minus-z': alongAxis(aspect, 2, -1),
    }),
  }),
  scene({
    name: 'colour-camera-at-the-centre',
    breaks:
      'The direction 0/0 of a splat in the camera is NaN, and with it all that is summed or sorted by it.',
    clouds: () => [
      {
        set: splatsOf(withRandomSh([...ordinarySplats(), { ...HARD, position: [0, 0, 5] }], 3, 0.5), {
          shDegree: 3,
        }),
      },
    ],
    cameras: frontOnly,
  }),
  scene({
    name: 'colour-direction-of-length-1e-20',
    breaks: 'The squared length of the direction underflows to 0, and normalising it divides by 0.',
    clouds: () => {
      const tiny = {
        position: [2e-21, 1e-21, -1e-20],
        logScales: [-48, -48, -48],
        opacityLogit: logitOf(0.5),
      };
      const splats = [...moved(ordinarySplats(), [0, 0, -6]), { ...tiny, color: [0.6, 0.5, 0.4] }];
      return [{ set: splatsOf(withRandomSh(splats, 3, 0.4), { shDegree: 3 }) }];
    },
    cameras: (aspect) => atOrigin(aspect, { near: 1e-24, far: 1000 }),
  }),
];
