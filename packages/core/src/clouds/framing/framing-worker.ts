import { serve } from '../../io/remote.ts';
import { builderTasks } from '../geometry-builder.ts';
import { FRAMING_BUILDERS } from './framing-builder.ts';

serve(builderTasks(FRAMING_BUILDERS));
