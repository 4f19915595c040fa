import type { AccuracyPreset } from '@websplatter/core';
import { createSplatRenderer, SplatCloudObject, SplatLoader, splatEngineOf } from '@websplatter/three';
import { REVISION } from 'three/webgpu';
import { type LoadPeer, nextTask, type PeerFormats } from '../adapter.ts';
import { threeOptions, threeScene } from './three-scene.ts';

export const formats: PeerFormats = 'any';

/**
 * This project's engine in three.js. Options of the page's URL: `accuracy=PRESET`; `msaa` draws with
 * four samples; `mesh` adds a mesh that hides splats.
 */
const loadWebsplatterThree: LoadPeer = async ({ canvas, url, options }) => {
  const accuracy = (options.get('accuracy') ?? 'balanced') as AccuracyPreset;
  const renderer = await createSplatRenderer({ canvas, ...threeOptions(options), accuracy });
  const { scene, setCamera, draw } = threeScene(renderer, canvas, options);
  const object = new SplatCloudObject(await new SplatLoader().detectSupport(renderer).loadAsync(url));
  scene.add(object);
  let isShown = false;
  let problem: unknown;
  object.addEventListener('firstframe', () => {
    isShown = true;
  });
  object.onError = (error) => {
    problem = error;
  };
  return {
    note: `${accuracy}, WebGPURenderer r${REVISION}`,
    setCamera,
    draw: async () => {
      draw();
      // Until its shaders are compiled an object is left out of the image.
      while (!isShown) {
        await nextTask();
        if (problem) throw problem;
        draw();
      }
    },
    figures: () => ({ memory: splatEngineOf(renderer)?.memory() }),
  };
};
export default loadWebsplatterThree;
