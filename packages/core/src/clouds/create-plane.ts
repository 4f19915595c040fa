import { GEOMETRY_WORDS } from '../data/packing/geometry.ts';
import { shWordsPerSplat } from '../data/packing/harmonics.ts';
import type { GeometryPrecision, OwnShPrecision } from '../data/packing/precision.ts';
import type { ShDegree } from '../data/splats/splat-set.ts';
import { type Plane, type PlanePlace, planeOf } from './cloud-planes.ts';

/** Creates an empty plane for the GPU to fill. @throws GpuLimitError; nothing is allocated then. */
export function createGeometry(place: PlanePlace, precision: GeometryPrecision): Plane {
  return createPlane(place, GEOMETRY_WORDS[precision], 'geometry');
}

/**
 * Creates an empty plane of harmonics for the GPU to fill; empty at degree 0. @throws
 * GpuLimitError; nothing is allocated then.
 */
export function createHarmonics(place: PlanePlace, degree: ShDegree, precision: OwnShPrecision): Plane {
  return degree === 0 ? [] : createPlane(place, shWordsPerSplat(degree, precision), 'spherical harmonics');
}

function createPlane(place: PlanePlace, wordsPerSplat: number, what: string): Plane {
  return planeOf(place, ({ start, end }, page) => {
    const bytes = 4 * wordsPerSplat * (end - start);
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC | GPUBufferUsage.COPY_DST;
    return place.memory.createBuffer(`${place.name} ${what} ${page}`, bytes, usage);
  });
}
