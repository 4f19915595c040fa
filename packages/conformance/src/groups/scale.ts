import type { HardCase } from '../hard-case.ts';
import { amongOrdinary, FRONT_PX_PER_UNIT, frontOnly, scenesOf } from '../make-cases.ts';
import { logitOf, type SplatValues, splatsOf } from '../make-splats.ts';

const scene = scenesOf('scale');

/** The smallest logarithm whose exponential is 0 in float32. */
const LOG_ZERO = -104;

/** A half-transparent splat in front of the ordinary ones, with no axis parallel to the image's. */
const hard = (logScales: readonly number[]): SplatValues => ({
  position: [0.2, -0.1, 1.8],
  rotation: [0.9, 0.1, 0.2, 0.35],
  opacityLogit: logitOf(0.6),
  color: [1, 0.15, 0.1],
  logScales,
});

const uniform = (logScale: number) => [logScale, logScale, logScale];

/** Log scale of a splat at the origin whose standard deviation is `sizePx` for `front`. */
const logScaleOfPx = (sizePx: number) => Math.log(sizePx / FRONT_PX_PER_UNIT);

/** Opaque points in a grid with a step of no whole number of pixels, sized by dilation alone. */
const starField = (): SplatValues[] =>
  Array.from({ length: 400 }, (_, i) => ({
    position: [((i % 20) - 9.5) * 0.2813, (Math.floor(i / 20) - 9.5) * 0.2793, 0],
    logScales: uniform(-10),
    opacityLogit: 100,
    color: [1, 1, 1],
  }));

export const SCALE_CASES: readonly HardCase[] = [
  scene({
    name: 'scale-unit',
    breaks: 'Log scales that are stored as 0 are taken for unset and the splat is left out.',
    clouds: amongOrdinary([hard(uniform(0))]),
  }),
  scene({
    name: 'scale-zero-one-axis',
    breaks:
      'A disc has no inverse 3D covariance; inverting it gives NaN, or its edge on gives a determinant of 0.',
    clouds: amongOrdinary([hard([-1, -1, LOG_ZERO])]),
  }),
  scene({
    name: 'scale-zero-two-axes',
    breaks:
      'A line has a screen covariance of rank one, whose determinant cancels to 0 or below and loses the line.',
    clouds: amongOrdinary([hard([0, LOG_ZERO, LOG_ZERO])]),
  }),
  scene({
    name: 'scale-zero-all',
    breaks: 'A point has only the dilation for a size; dividing by its own determinant gives NaN.',
    clouds: amongOrdinary([hard(uniform(LOG_ZERO))]),
  }),
  ...[-100, -40].map((logScale) =>
    scene({
      name: `scale-log-minus-${-logScale}`,
      breaks:
        'Squares of the scale underflow to 0, and what divides by them or takes their logarithm is not finite.',
      clouds: amongOrdinary([hard(uniform(logScale))]),
    }),
  ),
  ...[40, 50, 88].map((logScale) =>
    scene({
      name: `scale-log-${logScale}`,
      breaks:
        'The determinant, a fourth power, overflows to Inf and the splat that covers everything disappears.',
      clouds: amongOrdinary([hard(uniform(logScale))]),
    }),
  ),
  scene({
    name: 'scale-log-40-one-axis',
    breaks:
      'One axis overflows while another stays small: Inf − Inf in the determinant turns the stripe into NaN.',
    clouds: amongOrdinary([hard([40, -2, -2])]),
  }),
  scene({
    name: 'needle-aspect-1e6',
    breaks: 'The smaller eigenvalue is taken as mid − radius, which cancels to 0 for a needle.',
    clouds: amongOrdinary([hard([Math.log(1e3), Math.log(1e-3), Math.log(1e-3)])]),
  }),
  scene({
    name: 'needles-aspect-1e3-crossing',
    breaks: 'Needles at every angle show an eigenvector that is undefined where the off-diagonal term is 0.',
    clouds: amongOrdinary(
      Array.from({ length: 16 }, (_, i) => ({
        ...hard([Math.log(2), Math.log(2e-3), Math.log(2e-3)]),
        position: [0, 0, 1 + i / 32],
        rotation: [Math.cos((i * Math.PI) / 32), 0, 0, Math.sin((i * Math.PI) / 32)],
        color: [i / 15, 1 - i / 15, 0.5],
      })),
    ),
  }),
  scene({
    name: 'needles-almost-axis-aligned',
    breaks:
      'An eigenvector from λ₁ − a cancels where a needle is almost parallel to an axis, and is off by its slope.',
    clouds: amongOrdinary(
      [0, Math.PI / 2].flatMap((angle) =>
        [1e-4, -1e-4, 0].map((slope, i) => ({
          ...hard([logScaleOfPx(2e4), logScaleOfPx(1), logScaleOfPx(1)]),
          position: [0.05, 0.1 * i, i / 8],
          rotation: [Math.cos((angle + slope) / 2), 0, 0, Math.sin((angle + slope) / 2)],
        })),
      ),
    ),
    cameras: frontOnly,
  }),
  scene({
    name: 'scale-points-between-pixels',
    breaks:
      'Rasterisers snap corners to a grid of up to 1/16 px, which moves points of the size of a pixel by as much.',
    clouds: () => [{ set: splatsOf(starField()) }],
    cameras: frontOnly,
  }),
  ...[
    ['1e-6', 1e-6],
    ['0.1', 0.1],
    ['1e3', 1e3],
    ['7e4', 7e4],
  ].map(([label, sizePx]) =>
    scene({
      name: `scale-screen-axis-${String(label).replace('.', '-')}-px`,
      breaks:
        Number(sizePx) < 1
          ? 'An axis far below a pixel is lost beside the dilation, or normalised from a zero vector.'
          : 'Screen axes are capped to spare the quad, which makes another Gaussian of it, or do not fit a float16.',
      clouds: amongOrdinary([
        {
          ...hard([logScaleOfPx(Number(sizePx)), logScaleOfPx(4), logScaleOfPx(4)]),
          position: [0.3, 0.2, 0],
        },
      ]),
    }),
  ),
];
