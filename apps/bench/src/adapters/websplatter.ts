import { type AccuracyPreset, type Camera, perspectiveCamera, SplatEngine } from '@websplatter/core';
import type { LoadPeer } from '../adapter.ts';

/** This project's engine on a canvas. `?accuracy=PRESET`. */
const loadWebsplatter: LoadPeer = async ({ canvas, url, options }) => {
  const accuracy = (options.get('accuracy') ?? 'balanced') as AccuracyPreset;
  const engine = await SplatEngine.create({ accuracy });
  const view = engine.createView({ canvas });
  const clouds = [{ cloud: await engine.load(url) }];
  const size = { widthPx: canvas.width, heightPx: canvas.height };
  let camera: Camera;
  return {
    note: accuracy,
    setCamera: (by) => {
      camera = perspectiveCamera({ ...by, aspect: size.widthPx / size.heightPx });
    },
    draw: () => {
      view.render({ camera, clouds, ...size, force: true });
      return view.whenDrawn();
    },
    figures: () => ({ statistics: view.statistics, memory: engine.memory() }),
  };
};
export default loadWebsplatter;
