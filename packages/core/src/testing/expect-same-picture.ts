import { expect } from 'vitest';
import type { Harmonics } from '../data/packing/harmonics.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { renderReference } from '../reference/render.ts';
import { compareImages } from '../stages/measure/measure.reference.ts';
import { testCameras } from './test-cameras.ts';

const SIZE = { widthPx: 64, heightPx: 48 };

/** Expects the float64 pictures of two sets, of half extent 1, to be at least `leastDb` alike. */
export function expectSamePicture(
  found: SplatSet<Harmonics>,
  expected: SplatSet<Harmonics>,
  leastDb: number,
): void {
  const { perspective: camera } = testCameras(SIZE.widthPx / SIZE.heightPx);
  const [a, b] = [found, expected].map((set) => renderReference({ clouds: [{ set }], camera, ...SIZE }));
  expect(b.visibleSplats).toBeGreaterThan(0);
  expect(compareImages(a.data, b.data, SIZE).psnrDb).toBeGreaterThan(leastDb);
}
