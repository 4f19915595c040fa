import { type ScenePort, serveScene } from '../loading/serve-scene.ts';
import { SCENE_TASKS } from './scene-tasks.ts';

serveScene(self as unknown as ScenePort, SCENE_TASKS);
