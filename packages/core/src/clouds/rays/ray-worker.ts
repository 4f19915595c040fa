import { serve } from '../../io/remote.ts';
import { builderTasks } from '../geometry-builder.ts';
import { RAY_BUILDERS } from './ray-tree-builder.ts';

serve(builderTasks(RAY_BUILDERS));
