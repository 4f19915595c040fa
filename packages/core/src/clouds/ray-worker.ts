import { type ServerPort, serve } from '../io/remote.ts';
import { builderTasks } from './geometry-builder.ts';
import { RAY_BUILDERS } from './ray-tree-builder.ts';

serve(self as unknown as ServerPort, builderTasks(RAY_BUILDERS));
