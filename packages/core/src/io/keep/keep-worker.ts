import { serve } from '../remote.ts';
import { KEEP_TASKS } from './serve-keep.ts';

serve(KEEP_TASKS);
