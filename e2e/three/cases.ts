import { BoxGeometry, Color, Mesh, MeshBasicMaterial, REVISION } from 'three/webgpu';
import { splatCloud } from './splats.ts';
import { newStage, type RendererParameters, shot } from './stage.ts';

/** Run by name from the tests; what they return is compared there. */
export const cases = {
  revision: async () => REVISION,

  /** A white splat of half opacity over `background`. */
  over: async (background: number, parameters: RendererParameters = {}) => {
    const stage = await newStage(parameters);
    stage.scene.background = new Color(background);
    stage.scene.add(splatCloud({}));
    return shot(stage);
  },

  box: async () => {
    const stage = await newStage();
    stage.scene.add(new Mesh(new BoxGeometry(), new MeshBasicMaterial({ color: 0xff0000 })), splatCloud({}));
    return shot(stage);
  },
};
