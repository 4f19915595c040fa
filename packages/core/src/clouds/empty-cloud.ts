import type { CloudPrecision } from '../data/packing/precision.ts';
import type { ShDegree } from '../data/splats/splat-set.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import { CloudPlanes } from './cloud-planes.ts';
import { SplatCloud } from './splat-cloud.ts';

/**
 * A cloud without splats. Its frames use the shaders that most clouds of this degree and precision
 * need.
 */
export function emptyCloud(memory: GpuMemory, shDegree: ShDegree, precision: CloudPrecision): SplatCloud {
  const name = 'empty';
  const none = { ranges: [], chunks: [], geometry: [], harmonics: [] };
  const planes = new CloudPlanes(memory, name, { ...precision, ...none, shDegree });
  const bounds = { min: [0, 0, 0], max: [0, 0, 0] } as const;
  const contents = {
    count: 0,
    origin: [0, 0, 0],
    bounds,
    robustBounds: bounds,
    dropped: {},
    fileIndices: new Uint32Array(0),
    facts: {
      declaredShDegree: shDegree,
      trueShDegree: shDegree,
      shBandReach: [],
      paletteEntries: null,
      isIsotropic: false,
      isAntialiased: null,
      fileFacts: null,
    },
    chunks: new ArrayBuffer(0),
    precision,
  } as const;
  return new SplatCloud(memory.device, planes, contents, { name });
}
