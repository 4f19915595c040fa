import type { HardCase } from '../hard-case.ts';
import { amongOrdinary, scenesOf } from '../make-cases.ts';
import { logitOf, type SplatValues } from '../make-splats.ts';

const scene = scenesOf('opacity');

const hard = (opacityLogit: number): SplatValues => ({
  position: [0.1, 0.1, 1.7],
  logScales: [-0.7, -0.9, -1.1],
  color: [0.95, 0.2, 0.9],
  opacityLogit,
});

/** Splats of lower opacity are not drawn at all. */
const CUTOFF_LOGIT = logitOf(1 / 255);

/** The float32 that is `steps` ulp from `value`. */
function stepped(value: number, steps: number): number {
  const floats = Float32Array.of(value);
  const bits = new Int32Array(floats.buffer);
  bits[0] += floats[0] < 0 ? -steps : steps;
  return floats[0];
}

const atCutoff = (name: string, steps: number) =>
  scene({
    name,
    breaks: 'Opacity that is rounded to 8 bits before the cutoff falls on the wrong side of 1/255.',
    clouds: amongOrdinary([hard(stepped(CUTOFF_LOGIT, steps))]),
    decidesAtThreshold: 'peak opacity within 2 ulp of the cutoff 1/255',
  });

export const OPACITY_CASES: readonly HardCase[] = [
  ...(
    [
      ['100', 100],
      ['infinity', Number.POSITIVE_INFINITY],
    ] as const
  ).map(([label, logit]) =>
    scene({
      name: `opacity-logit-${label}`,
      breaks: 'An opacity of 1 gives a transmittance of 0, and its logarithm or reciprocal is not finite.',
      clouds: amongOrdinary([hard(logit)]),
    }),
  ),
  ...(
    [
      ['100', -100],
      ['infinity', Number.NEGATIVE_INFINITY],
    ] as const
  ).map(([label, logit]) =>
    scene({
      name: `opacity-logit-minus-${label}`,
      breaks:
        'exp(−logit) overflows and Inf·0, or the logarithm of opacity 0, makes a splat of NaN that should not be.',
      clouds: amongOrdinary([hard(logit)]),
    }),
  ),
  scene({
    name: 'opacity-one',
    breaks: 'Fragments reach an alpha of 1 where 0.99 is the most, which hides everything behind for good.',
    // 1 − σ(17) is less than half an ulp of 1 in float32.
    clouds: amongOrdinary([hard(17)]),
  }),
  atCutoff('opacity-at-cutoff', 0),
  atCutoff('opacity-one-ulp-above-cutoff', 1),
  atCutoff('opacity-one-ulp-below-cutoff', -1),
  scene({
    name: 'opacity-just-above-cutoff',
    breaks:
      'The reach √(2·ln(σ·255)) of a splat hardly above the cutoff is NaN or 0, and its middle pixel is lost.',
    // So wide that its reach, a fifth of a standard deviation, is a few pixels.
    clouds: amongOrdinary([{ ...hard(logitOf(1.02 / 255)), logScales: [0, 0, 0], color: [1, 1, 1] }]),
  }),
  scene({
    name: 'opacity-faint-veil',
    breaks:
      'A faint splat that covers the image is cut off where its alpha, not its colour, is rounded to 8 bits.',
    clouds: amongOrdinary([{ ...hard(logitOf(4 / 255)), logScales: [1, 1, 1], color: [1, 1, 1] }]),
  }),
];
