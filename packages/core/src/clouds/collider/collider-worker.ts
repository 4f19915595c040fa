import { type BuildPort, serveBuilder } from '../geometry-builder.ts';
import { COLLIDER_BUILDERS } from './build-collider.ts';

serveBuilder(self as unknown as BuildPort, COLLIDER_BUILDERS);
