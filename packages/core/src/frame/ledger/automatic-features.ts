import type { AutomaticFeature } from './automatic-feature.ts';
import { depthTest } from './features/depth-test.ts';
import { depthWrite } from './features/depth-write.ts';
import { distanceOrder } from './features/distance-order.ts';
import { harmonics } from './features/harmonics.ts';
import { instances } from './features/instances.ts';
import { isotropic } from './features/isotropic.ts';
import { levels } from './features/levels.ts';
import { orthographic } from './features/orthographic.ts';
import { tiles } from './features/tiles.ts';
import { transform } from './features/transform.ts';

/** All automatic features: those that the data of clouds, the view or its host make necessary. */
export const AUTOMATIC_FEATURES: readonly AutomaticFeature[] = [
  harmonics,
  isotropic,
  levels,
  transform,
  instances,
  orthographic,
  distanceOrder,
  depthTest,
  depthWrite,
  tiles,
];
