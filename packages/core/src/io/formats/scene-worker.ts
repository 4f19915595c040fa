import { serve } from '../remote.ts';
import { SCENE_TASKS, WAITING_TASKS } from './scene-tasks.ts';

serve(SCENE_TASKS, undefined, WAITING_TASKS);
