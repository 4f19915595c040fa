import { type AccuracyPreset, perspectiveCamera, type SplatCloud, SplatEngine } from '@websplatter/core';
import { antialias } from '@websplatter/core/effects';
import type { SceneCamera } from '@websplatter/scenes';
import type { LoadPeer, PeerFormats } from '../adapter.ts';

export const formats: PeerFormats = 'any';

/**
 * Draws with this project's engine on a canvas. Options of the page's URL: `accuracy=PRESET`;
 * `antialias`; `maxShare=0.2` limits a frame to that share of the splats in sight; `previews` draws
 * splats while a scene loads; `undivided` submits every frame at once, however long it takes.
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
  const maxShare = Number(options.get('maxShare') ?? 1);
  if (maxShare < 1) await cloud.makeLevels();
  // Without effects a file that was trained antialiased has that.
  const clouds = [{ cloud, effects: options.has('antialias') ? [antialias()] : [] }];
  const frame = { clouds, ...size, detail: maxShare < 1 ? { maxShare } : 'full', force: true } as const;
  return {
    note: hasPreviews ? `${accuracy}, shown while it loads` : accuracy,
    setCamera: (by) => {
      camera = cameraBy(by);
    },
    draw: () => {
      view.render({ camera, ...frame });
      return view.whenDrawn();
    },
    figures: () => ({ statistics: view.statistics, memory: engine.memory() }),
  };
};
export default loadWebsplatter;
