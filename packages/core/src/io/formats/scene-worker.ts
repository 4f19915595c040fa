import { type ServerPort, serve } from '../remote.ts';
import { SCENE_TASKS } from './scene-tasks.ts';

serve(self as unknown as ServerPort, SCENE_TASKS);
