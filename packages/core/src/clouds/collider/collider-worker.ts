import { serve } from '../../io/remote.ts';
import { builderTasks } from '../geometry-builder.ts';
import { COLLIDER_BUILDERS } from './build-collider.ts';

serve(builderTasks(COLLIDER_BUILDERS));
