import { depthTest } from './found/depth-test.ts';
import { depthWrite } from './found/depth-write.ts';
import { distanceOrder } from './found/distance-order.ts';
import { harmonics } from './found/harmonics.ts';
import { isotropic } from './found/isotropic.ts';
import { orthographic } from './found/orthographic.ts';
import { tiles } from './found/tiles.ts';
import { transform } from './found/transform.ts';
import type { FoundEffect } from './found-effect.ts';

/** All found effects: those that the data of clouds, the view or its host make necessary. */
export const FOUND_EFFECTS: readonly FoundEffect[] = [
  harmonics,
  isotropic,
  transform,
  orthographic,
  distanceOrder,
  depthTest,
  depthWrite,
  tiles,
];
