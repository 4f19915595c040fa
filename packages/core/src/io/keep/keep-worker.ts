import { type ServerPort, serve } from '../remote.ts';
import { KEEP_TASKS } from './serve-keep.ts';

serve(self as unknown as ServerPort, KEEP_TASKS);
