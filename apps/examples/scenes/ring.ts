import { encodePly, type SplatSet } from '@websplatter/core';
import { GOLDEN_RATIO, splatsOf, wheel } from './splats.ts';

const COUNT = 6_000;
const RADIUS = 1;
const TUBE_RADIUS = 0.22;

export const ringPly = (): Uint8Array => encodePly(ring());

/** Returns a torus of translucent splats about the z axis, with all hues once around. */
export function ring(): SplatSet {
  return splatsOf(COUNT, (i) => {
    const around = (2 * Math.PI * i) / COUNT;
    const aroundTube = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
    const distance = RADIUS + TUBE_RADIUS * Math.cos(aroundTube);
    return {
      position: [
        distance * Math.cos(around),
        distance * Math.sin(around),
        TUBE_RADIUS * Math.sin(aroundTube),
      ],
      scale: 0.022,
      color: wheel(i / COUNT),
      opacityLogit: 1,
    };
  });
}
