import { type ServerPort, serve } from '../../io/remote.ts';
import { builderTasks } from '../geometry-builder.ts';
import { COLLIDER_BUILDERS } from './build-collider.ts';

serve(self as unknown as ServerPort, builderTasks(COLLIDER_BUILDERS));
