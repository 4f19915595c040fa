import { type ServerPort, serve } from '../../io/remote.ts';
import { builderTasks } from '../geometry-builder.ts';
import { FRAMING_BUILDERS } from './framing-builder.ts';

serve(self as unknown as ServerPort, builderTasks(FRAMING_BUILDERS));
