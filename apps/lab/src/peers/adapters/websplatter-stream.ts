import { type AccuracyPreset, perspectiveCamera, SplatEngine } from '@websplatter/core';
import type { SceneCamera } from '@websplatter/scenes';
import type { LoadPeer } from '../adapter.ts';

/**
 * This project's engine with a scene that streams. `?accuracy=PRESET`; `?maxSplats=N` are drawn at
 * most and `?budgetBytes=N` held on the GPU, without limits where these are missing.
 */
const loadStream: LoadPeer = async ({ canvas, url, camera: first, options }) => {
  const limit = (name: string) => Number(options.get(name) ?? Number.POSITIVE_INFINITY);
  const [maxSplats, budgetBytes] = [limit('maxSplats'), limit('budgetBytes')];
  const accuracy = (options.get('accuracy') ?? 'balanced') as AccuracyPreset;
  const engine = await SplatEngine.create({ accuracy });
  const view = engine.createView({ canvas });
  const cloud = await engine.load(url, { budgetBytes });
  const { stream } = cloud;
  if (!stream) throw new Error(`${url} does not stream.`);
  const size = { widthPx: canvas.width, heightPx: canvas.height };
  const cameraBy = (by: SceneCamera) => perspectiveCamera({ ...by, aspect: size.widthPx / size.heightPx });
  let camera = cameraBy(first);
  const detail = Number.isFinite(maxSplats) ? { maxSplats } : 'full';
  return {
    note: `${accuracy}, maxSplats ${maxSplats}, budgetBytes ${budgetBytes}`,
    setCamera: (by) => {
      camera = cameraBy(by);
    },
    draw: () => {
      view.render({ camera, clouds: [{ cloud }], ...size, detail, force: true });
      return view.whenDrawn();
    },
    isComplete: () => {
      const { isComplete, error } = stream.report();
      if (error) throw error;
      return isComplete;
    },
    figures: () => ({
      splats: view.statistics?.visibleSplats,
      stream: stream.report(),
      memory: engine.memory(),
    }),
  };
};
export default loadStream;
