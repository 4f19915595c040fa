import { type PackedCloud, packCloud, type SplatSet } from '@websplatter/core';
import { SplatData } from '../cloud/splat-data.ts';

/** Small white splats at `positions`. For tests. */
export function splatSetAt(...positions: readonly (readonly [number, number, number])[]): SplatSet {
  const count = positions.length;
  return {
    count,
    origin: [0, 0, 0],
    positions: Float32Array.from(positions.flat()),
    logScales: new Float32Array(3 * count).fill(Math.log(0.01)),
    rotations: Float32Array.from(positions.flatMap(() => [1, 0, 0, 0])),
    opacityLogits: new Float32Array(count),
    colorDc: new Float32Array(3 * count),
    harmonics: { degree: 0, coefficients: new Float32Array(0) },
    fileIndices: Uint32Array.from(positions, (_, i) => i),
    dropped: {},
  };
}

/** The same, packed as `balanced` has it. */
export function packedCloudAt(...positions: readonly (readonly [number, number, number])[]): PackedCloud {
  return packCloud(splatSetAt(...positions), { geometryPrecision: 'packed', shPrecision: 'u8' });
}

export function splatDataAt(...positions: readonly (readonly [number, number, number])[]): SplatData {
  return new SplatData(packedCloudAt(...positions), 'test');
}
