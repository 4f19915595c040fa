import { advance, createRoot } from '@react-three/fiber';
import { createSplatRenderer, type SplatData, Splats, splatEngineOf } from '@websplatter/react';
import { Suspense } from 'react';
import { REVISION } from 'three/webgpu';
import { type LoadPeer, nextTask } from '../adapter.ts';
import { isStreamComplete, streamOptions } from './stream-options.ts';
import { threeCamera } from './three-scene.ts';

/** This project's `<Splats>` in react-three-fiber, with a scene that streams. */
const loadReactStream: LoadPeer = async ({ canvas, url, options }) => {
  const { accuracy, budgetBytes, detail, note } = streamOptions(options);
  const { camera, setCamera } = threeCamera(canvas);
  const { width, height } = canvas;
  const renderer = await createSplatRenderer({ canvas, accuracy, antialias: false });
  renderer.setClearColor(0x000000, 1);
  const root = createRoot(canvas);
  await root.configure({
    gl: () => renderer,
    camera: Object.assign(camera, { manual: true }),
    size: { width, height, top: 0, left: 0 },
    dpr: 1,
    flat: true,
    frameloop: 'never',
  });
  let isShown = false;
  const data = await new Promise<SplatData>((resolve, reject) => {
    root.render(
      <Suspense>
        <Splats
          src={url}
          budgetBytes={budgetBytes}
          detail={detail}
          onFirstFrame={() => {
            isShown = true;
          }}
          onLoad={resolve}
          onError={reject}
        />
      </Suspense>,
    );
  });
  const engine = splatEngineOf(renderer)!;
  const { stream } = await data.acquire(engine, {});
  if (!stream) throw new Error(`${url} does not stream.`);
  const draw = () => advance(performance.now());
  return {
    note: `${note}, three r${REVISION}`,
    setCamera,
    draw: async () => {
      draw();
      // Until its shaders are compiled an object is left out of the image.
      while (!isShown) {
        await nextTask();
        draw();
      }
    },
    isComplete: () => isStreamComplete(stream),
    figures: () => ({ stream: stream.report(), memory: engine.memory() }),
  };
};
export default loadReactStream;
