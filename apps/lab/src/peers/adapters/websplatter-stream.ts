import { perspectiveCamera, SplatEngine } from '@websplatter/core';
import type { SceneCamera } from '@websplatter/scenes';
import type { LoadPeer } from '../adapter.ts';
import { isStreamComplete, streamOptions } from './stream-options.ts';

/** This project's engine with a scene that streams. */
const loadStream: LoadPeer = async ({ canvas, url, camera: first, options }) => {
  const { accuracy, budgetBytes, detail, note } = streamOptions(options);
  const engine = await SplatEngine.create({ accuracy });
  const view = engine.createView({ canvas });
  const cloud = await engine.load(url, { budgetBytes });
  const { stream } = cloud;
  if (!stream) throw new Error(`${url} does not stream.`);
  const size = { widthPx: canvas.width, heightPx: canvas.height };
  const cameraBy = (by: SceneCamera) => perspectiveCamera({ ...by, aspect: size.widthPx / size.heightPx });
  let camera = cameraBy(first);
  return {
    note,
    setCamera: (by) => {
      camera = cameraBy(by);
    },
    draw: () => {
      view.render({ camera, clouds: [{ cloud }], ...size, detail, force: true });
      return view.whenDrawn();
    },
    isComplete: () => isStreamComplete(stream),
    figures: () => ({
      splats: view.statistics?.visibleSplats,
      stream: stream.report(),
      memory: engine.memory(),
    }),
  };
};
export default loadStream;
