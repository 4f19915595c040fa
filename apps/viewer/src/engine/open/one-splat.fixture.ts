import type { SplatSet } from '@websplatter/core';

/** One splat at 1, 2, 3. */
export const oneSplat: SplatSet = {
  count: 1,
  origin: [0, 0, 0],
  positions: Float32Array.of(1, 2, 3),
  logScales: new Float32Array(3),
  rotations: Float32Array.of(1, 0, 0, 0),
  opacityLogits: new Float32Array(1),
  colorDc: new Float32Array(3),
  harmonics: { degree: 0, coefficients: new Float32Array() },
  fileIndices: new Uint32Array(1),
  dropped: {},
};
