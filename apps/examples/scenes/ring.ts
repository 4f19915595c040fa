import { encodePly, type SplatSet } from '@websplatter/core';

/** A colour channel of 0…1 is 0.5 + its coefficient · SH_C0. */
const SH_C0 = 0.28209479177387814;
const COUNT = 6_000;
const RADIUS = 1;
const TUBE_RADIUS = 0.22;
const GOLDEN_RATIO = (1 + Math.sqrt(5)) / 2;

export const ringPly = (): Uint8Array => encodePly(ring());

/** Returns a torus of translucent splats about the z axis, coloured once around the wheel. */
export function ring(): SplatSet {
  const positions = new Float32Array(3 * COUNT);
  const logScales = new Float32Array(3 * COUNT).fill(Math.log(0.022));
  const rotations = new Float32Array(4 * COUNT);
  const opacityLogits = new Float32Array(COUNT).fill(1);
  const colorDc = new Float32Array(3 * COUNT);
  for (let i = 0; i < COUNT; i++) {
    const around = (2 * Math.PI * i) / COUNT;
    // Successive splats lie as far apart around the tube as they can.
    const aroundTube = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
    const distance = RADIUS + TUBE_RADIUS * Math.cos(aroundTube);
    positions[3 * i] = distance * Math.cos(around);
    positions[3 * i + 1] = distance * Math.sin(around);
    positions[3 * i + 2] = TUBE_RADIUS * Math.sin(aroundTube);
    rotations[4 * i] = 1;
    for (let channel = 0; channel < 3; channel++) {
      const value = 0.55 + 0.4 * Math.cos(around - (2 * Math.PI * channel) / 3);
      colorDc[3 * i + channel] = (value - 0.5) / SH_C0;
    }
  }
  return {
    count: COUNT,
    origin: [0, 0, 0],
    positions,
    logScales,
    rotations,
    opacityLogits,
    colorDc,
    harmonics: { degree: 0, coefficients: new Float32Array(0) },
    fileIndices: Uint32Array.from({ length: COUNT }, (_, i) => i),
    dropped: {},
  };
}
