import { GaussianSplatPLYLoader } from 'three/addons/loaders/GaussianSplatPLYLoader.js';
import { GaussianSplat } from 'three/addons/objects/GaussianSplat.js';
import * as THREE from 'three/webgpu';
import type { LoadPeer } from '../adapter.ts';
import { threeScene } from './three-scene.ts';

/** GaussianSplat of three's own addons. */
const loadThree: LoadPeer = async ({ canvas, url }) => {
  const renderer = new THREE.WebGPURenderer({ canvas, antialias: false });
  await renderer.init();
  // Splats are blended in the space that they were trained in; three would encode them a second time.
  renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
  const { scene, setCamera, draw } = threeScene(renderer, canvas);
  const splat = new GaussianSplat(await new GaussianSplatPLYLoader().loadAsync(url));
  splat.frustumCulled = false;
  scene.add(splat);
  return { note: `WebGPURenderer r${THREE.REVISION}, output not encoded again`, setCamera, draw };
};
export default loadThree;
