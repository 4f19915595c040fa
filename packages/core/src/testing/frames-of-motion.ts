import type { SplatSet } from '../data/splats/splat-set.ts';
import { seededRandom } from './seeded-random.ts';

/**
 * Frames of a scene as trackers write them: equal rows in equal order. A third of the splats stands still, a
 * third turns about the vertical axis through the origin, and the last third waves, grows, shrinks and
 * changes its colour and opacity. Everything that moves also trembles a little.
 */
export function framesOfMotion(set: SplatSet, frameCount: number, perS = 30): SplatSet[] {
  const random = seededRandom(7);
  return Array.from({ length: frameCount }, (_, frame) => {
    const time = frame / perS;
    const positions = set.positions.slice();
    const rotations = set.rotations.slice();
    const logScales = set.logScales.slice();
    const colorDc = set.colorDc.slice();
    const opacityLogits = set.opacityLogits.slice();
    const angle = 0.8 * time;
    const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
    const [halfCosine, halfSine] = [Math.cos(angle / 2), Math.sin(angle / 2)];
    for (let i = 0; i < set.count; i++) {
      if (i % 3 === 0) continue;
      const [x, y, z] = positions.subarray(3 * i, 3 * i + 3);
      const tremble = () => 0.02 * Math.exp(set.logScales[3 * i]) * (random() - 0.5);
      if (i % 3 === 1) {
        positions[3 * i] = cosine * x + sine * z + tremble();
        positions[3 * i + 2] = cosine * z - sine * x + tremble();
        const [a, b, c, d] = set.rotations.subarray(4 * i, 4 * i + 4);
        rotations[4 * i] = halfCosine * a - halfSine * c;
        rotations[4 * i + 1] = halfCosine * b + halfSine * d;
        rotations[4 * i + 2] = halfCosine * c + halfSine * a;
        rotations[4 * i + 3] = halfCosine * d - halfSine * b;
      } else {
        const wave = Math.sin(6 * time + 4 * x);
        positions[3 * i + 1] = y + 0.05 * wave + tremble();
        opacityLogits[i] += 0.5 * wave;
        for (let axis = 0; axis < 3; axis++) {
          logScales[3 * i + axis] += 0.1 * wave;
          colorDc[3 * i + axis] += 0.1 * wave;
        }
      }
    }
    return { ...set, positions, rotations, logScales, colorDc, opacityLogits };
  });
}
