// An adapter for the lab as somebody else would write it: it draws less than there is.
import { perspectiveCamera, SplatEngine } from '@websplatter/core';

export default async function loadFaint({ canvas, url }) {
  const engine = await SplatEngine.create();
  const view = engine.createView({ canvas });
  const clouds = [{ cloud: await engine.load(url), opacity: 0.5 }];
  const size = { widthPx: canvas.width, heightPx: canvas.height };
  let camera;
  return {
    note: 'half the opacity',
    setCamera: (by) => {
      camera = perspectiveCamera({ ...by, aspect: size.widthPx / size.heightPx });
    },
    draw: () => {
      view.render({ camera, clouds, ...size, force: true });
      return view.whenDrawn();
    },
  };
}
