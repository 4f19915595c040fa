import type { HardCase, SceneCase } from '../hard-case.ts';
import { atOrigin, scenesOf } from '../make-cases.ts';
import { logitOf, moved, ordinarySplats, type SplatValues, splatsOf } from '../make-splats.ts';

const scene = scenesOf('accumulate');

const WHITE = [1, 1, 1];
const BLACK = [0, 0, 0];

interface Layers {
  readonly count: number;
  readonly alpha: number;
  /** Colour of layer `i`, counted from the camera. */
  readonly color?: (i: number) => readonly number[];
}

/** Layers wider than the image at dyadic depths from 1, unordered, before ordinary splats. */
function layers({ count, alpha, color = () => WHITE }: Layers): SplatValues[] {
  const nearestFirst = Array.from({ length: count }, (_, i) => ({
    position: [0, 0, -1 - i * 2 ** -12],
    logScales: [5, 5, -5],
    // Alpha beyond 0.99 is drawn as 0.99.
    opacityLogit: alpha < 0.99 ? logitOf(alpha) : 100,
    color: color(i),
  }));
  // This is a permutation, since 7 divides none of the counts.
  const shuffled = nearestFirst.map((_, i) => nearestFirst[(7 * i) % count]);
  return [...moved(ordinarySplats(), [0, 0, -6]), ...shuffled];
}

const layered = (name: string, breaks: string, what: Layers, bounds?: SceneCase['bounds']) =>
  scene({
    name,
    breaks,
    clouds: () => [{ set: splatsOf(layers(what)) }],
    cameras: (aspect) => atOrigin(aspect, { near: 0.01, far: 1000 }),
    size: { widthPx: 16, heightPx: 16 },
    bounds,
  });

const FAINT = 1.5 / 255;

/**
 * Bounds for sums that stall: in rgba16float a layer adds nothing once it is less than half an ulp of
 * the sum so far or, on devices that round towards zero, less than an ulp.
 */
const stalled = (minPsnrDb: number, minPsnrTruncatedDb?: number): SceneCase['bounds'] => {
  const cause =
    'blending in rgba16float rounds every layer, and stalls where a layer adds less than half a step';
  const bound = { minPsnrDb, minPsnrTruncatedDb, cause };
  return { high: bound, balanced: bound };
};

const alternating = (i: number) => (i % 2 === 0 ? WHITE : BLACK);
const inThirds = (i: number) =>
  [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ][i % 3];

export const ACCUMULATE_CASES: readonly HardCase[] = [
  layered('accumulate-1-layer', 'Nothing is hard here: cases with more layers are compared with this one.', {
    count: 1,
    alpha: FAINT,
  }),
  layered('accumulate-60-layers', 'In 8 bits per channel each layer is rounded, and sixty roundings show.', {
    count: 60,
    alpha: FAINT,
  }),
  layered(
    'accumulate-600-layers',
    'Blending stalls where a layer adds less than half a step of the target: two thirds of white in 8 bits.',
    { count: 600, alpha: FAINT },
    stalled(30, 23),
  ),
  layered(
    'accumulate-5000-layers',
    'Blending stalls for good in 8 and 16 bits, and per-tile lists of limited length leave the last layers out.',
    { count: 5000, alpha: FAINT },
    stalled(26, 21),
  ),
  layered(
    'accumulate-5000-layers-in-three-colours',
    'Each channel stalls or overflows its list by itself, and the wall of colours becomes tinted.',
    { count: 5000, alpha: 0.02, color: inThirds },
  ),
  layered(
    'accumulate-60-layers-alpha-0-99',
    'Transmittance becomes 0 in a few layers and its logarithm −Inf, or order errors behind the first layer show.',
    { count: 60, alpha: 0.99, color: inThirds },
  ),
  layered(
    'accumulate-5000-layers-alpha-0-99',
    'Transmittance underflows to denormals or 0, and what divides by it is not finite.',
    { count: 5000, alpha: 0.99, color: alternating },
  ),
  layered(
    'accumulate-600-layers-black-and-white',
    'Two swapped neighbours show at once, as do roundings that go one way.',
    { count: 600, alpha: 0.5, color: alternating },
  ),
  layered(
    'accumulate-5000-faint-layers-black-and-white',
    'Each layer moves the colour by about a step of an 8-bit target, and roundings that go one way add up.',
    { count: 5000, alpha: FAINT, color: alternating },
    stalled(29),
  ),
  scene({
    name: 'accumulate-600-edges',
    breaks:
      'Fragments below the cutoff are blended as far as the quad reaches, and 600 of them make its corners visible.',
    clouds: () => [
      {
        set: splatsOf([
          ...moved(ordinarySplats(), [0, 0, -6]),
          ...Array.from({ length: 600 }, (_, i) => ({
            position: [0, 0, -3 - i * 2 ** -12],
            logScales: [-1.2, -1.2, -1.2],
            opacityLogit: logitOf(0.02),
            color: WHITE,
          })),
        ]),
      },
    ],
    cameras: (aspect) => atOrigin(aspect, { near: 0.01, far: 1000 }),
    size: { widthPx: 32, heightPx: 32 },
  }),
];
