import { encodePly } from '@websplatter/core';
import { GOLDEN_RATIO, splatsOf, wheel } from './splats.ts';

const COUNT = 4_000;

/** A horizontal ring with running waves. `share`, 0…1, is their fraction of a full round. */
export function wavePly(share: number): Uint8Array {
  const phase = 2 * Math.PI * share;
  const splats = splatsOf(COUNT, (i) => {
    const around = (2 * Math.PI * i) / COUNT;
    const aroundTube = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
    const wave = Math.sin(5 * around - phase);
    const tube = 0.11 + 0.035 * Math.sin(2 * around + phase);
    const distance = 0.6 + tube * Math.cos(aroundTube);
    const light = 0.72 + 0.28 * Math.sin(aroundTube) + 0.1 * wave;
    const [red, green, blue] = wheel(i / COUNT, 0.5, 0.35);
    return {
      position: [
        distance * Math.cos(around),
        0.13 * wave + tube * Math.sin(aroundTube),
        distance * Math.sin(around),
      ],
      scale: 0.014,
      color: [red * light, green * light, blue * light],
    };
  });
  return encodePly(splats);
}
