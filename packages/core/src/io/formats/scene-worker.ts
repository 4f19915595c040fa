import { serve } from '../remote.ts';
import { SCENE_TASKS } from './scene-tasks.ts';

serve(SCENE_TASKS);
