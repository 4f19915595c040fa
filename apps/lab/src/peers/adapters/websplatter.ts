import { type AccuracyPreset, perspectiveCamera, type SplatCloud, SplatEngine } from '@websplatter/core';
import type { SceneCamera } from '@websplatter/scenes';
import type { LoadPeer, PeerFormats } from '../adapter.ts';

export const formats: PeerFormats = 'any';

/**
 * This project's engine on a canvas. `?accuracy=PRESET`; `?previews` shows what has arrived while
 * the rest loads; `?undivided` submits every frame at once, however long it may take.
 */
const loadWebsplatter: LoadPeer = async (host) => {
  const { canvas, options } = host;
  const accuracy = (options.get('accuracy') ?? 'balanced') as AccuracyPreset;
  const submissionBudgetMs = options.has('undivided') ? Number.POSITIVE_INFINITY : undefined;
  const engine = await SplatEngine.create({ accuracy, submissionBudgetMs });
  const view = engine.createView({ canvas });
  const size = { widthPx: canvas.width, heightPx: canvas.height };
  const cameraBy = (by: SceneCamera) => perspectiveCamera({ ...by, aspect: size.widthPx / size.heightPx });
  let camera = cameraBy(host.camera);
  const onPreview = (cloud: SplatCloud) => {
    view.render({ camera, clouds: [{ cloud }], ...size });
    // A view that cannot draw says so to the first frame that is asked for.
    view.whenDrawn().then(host.shown, () => {});
  };
  const hasPreviews = options.has('previews');
  const cloud = await engine.load(host.file ?? host.url, hasPreviews ? { onPreview } : {});
  const clouds = [{ cloud }];
  return {
    note: hasPreviews ? `${accuracy}, shown while it loads` : accuracy,
    setCamera: (by) => {
      camera = cameraBy(by);
    },
    draw: () => {
      view.render({ camera, clouds, ...size, force: true });
      return view.whenDrawn();
    },
    figures: () => ({ statistics: view.statistics, memory: engine.memory() }),
  };
};
export default loadWebsplatter;
