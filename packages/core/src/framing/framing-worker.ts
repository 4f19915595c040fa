import { builderTasks } from '../clouds/geometry-builder.ts';
import { serve } from '../io/remote.ts';
import { FRAMING_BUILDERS } from './framing-builder.ts';

serve(builderTasks(FRAMING_BUILDERS));
