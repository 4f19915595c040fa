import { type BuildPort, serveBuilder } from './geometry-builder.ts';
import { RAY_BUILDERS } from './ray-tree-builder.ts';

serveBuilder(self as unknown as BuildPort, RAY_BUILDERS);
