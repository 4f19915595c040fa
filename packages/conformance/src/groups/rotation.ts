import type { HardCase } from '../hard-case.ts';
import { amongOrdinary, scenesOf } from '../make-cases.ts';
import { logitOf, ordinarySplats, type SplatValues, splatsOf } from '../make-splats.ts';
import { patchedPly } from '../patch-ply.ts';

const scene = scenesOf('rotation');

/** A splat in front of the ordinary ones, so long that a wrong rotation changes the image. */
const hard = (rotation: readonly number[], change: SplatValues = {}): SplatValues => ({
  position: [0, 0, 1.7],
  logScales: [-0.3, -2, -3],
  opacityLogit: logitOf(0.85),
  color: [0.1, 0.9, 0.2],
  rotation,
  ...change,
});

const TURNED = [0.6, 0.1, -0.3, 0.7];
const times = (factor: number) => TURNED.map((value) => factor * value);

export const ROTATION_CASES: readonly HardCase[] = [
  scene({
    name: 'rotation-zero-quaternion',
    breaks: 'Normalising the zero quaternion divides 0 by 0; it stands for no rotation.',
    clouds: amongOrdinary([hard([0, 0, 0, 0])]),
  }),
  scene({
    name: 'rotation-norm-1e-20',
    breaks: 'The squared length of 1e-40 is flushed to 0 and the rotation becomes NaN or the identity.',
    clouds: amongOrdinary([hard(times(1e-20))]),
  }),
  scene({
    name: 'rotation-norm-1e20',
    breaks: 'The squared length of 1e40 overflows to Inf and the rotation becomes 0.',
    clouds: amongOrdinary([hard(times(1e20))]),
  }),
  scene({
    name: 'rotation-norm-denormal',
    breaks: 'Components that are denormal are flushed to 0, and with them the rotation.',
    clouds: amongOrdinary([hard(times(2 ** -130))]),
  }),
  scene({
    name: 'rotation-unnormalised',
    breaks: 'A quaternion that is used as it is scales the splat by the square of its length.',
    clouds: amongOrdinary([hard(times(3.7))]),
  }),
  scene({
    name: 'rotation-negated',
    breaks:
      'q and −q are one rotation; packing that drops the sign of the largest component turns the splat.',
    clouds: amongOrdinary([
      hard(TURNED, { position: [-0.8, 0, 1.7] }),
      hard(times(-1), { position: [0.8, 0, 1.8] }),
    ]),
  }),
  scene({
    name: 'rotation-two-largest-equal',
    breaks: 'Smallest-three packing picks one of two equal components and restores the wrong one.',
    clouds: amongOrdinary([
      hard([1, 1, 0, 0], { position: [-1, 0.9, 1.7] }),
      hard([1, 0, 0, -1], { position: [1, 0.9, 1.75] }),
      hard([-1, -1, -1, -1], { position: [-1, -0.9, 1.8] }),
      hard([0, 0, 1, 1], { position: [1, -0.9, 1.85] }),
    ]),
  }),
  ...[0, 1, 2, 3].map((component) =>
    scene({
      name: `rotation-nan-rot-${component}`,
      breaks: 'One NaN in a quaternion spreads to the covariance and to every pixel that the quad touches.',
      clouds: () => {
        const splats = [...ordinarySplats(), hard(TURNED)];
        const file = patchedPly(splatsOf(splats), [
          { row: splats.length - 1, property: `rot_${component}`, value: Number.NaN },
        ]);
        return [{ file }];
      },
      dropped: { 'non-finite-rotation': 1 },
    }),
  ),
];
