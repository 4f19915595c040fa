import { GaussianSplatPLYLoader } from 'three/addons/loaders/GaussianSplatPLYLoader.js';
import { GLTFGaussianSplatLoaderExtension } from 'three/addons/loaders/GLTFGaussianSplatLoaderExtension.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { KSPLATLoader } from 'three/addons/loaders/KSPLATLoader.js';
import { SPLATLoader } from 'three/addons/loaders/SPLATLoader.js';
import { SPZLoader } from 'three/addons/loaders/SPZLoader.js';
import { GaussianSplat } from 'three/addons/objects/GaussianSplat.js';
import * as THREE from 'three/webgpu';
import type { LoadPeer, PeerFormats } from '../adapter.ts';
import { threeOptions, threeScene } from './three-scene.ts';

export const formats: PeerFormats = ['ply', 'spz', 'splat', 'ksplat', 'gltf'];

/** By the end of a file's name. */
const GEOMETRY_LOADERS = {
  ply: GaussianSplatPLYLoader,
  spz: SPZLoader,
  splat: SPLATLoader,
  ksplat: KSPLATLoader,
} as const;

/** GaussianSplat of three's own addons. */
const loadThree: LoadPeer = async ({ canvas, url, fileName, options }) => {
  const renderer = new THREE.WebGPURenderer({ canvas, ...threeOptions(options) });
  await renderer.init();
  // Splats are blended in the space of their training; three would encode them a second time.
  renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
  const { scene, setCamera, draw } = threeScene(renderer, canvas, options);
  const splats = await loadSplats(url, fileName);
  splats.traverse((object) => {
    object.frustumCulled = false;
  });
  scene.add(splats);
  return { note: `WebGPURenderer r${THREE.REVISION}, output not encoded again`, setCamera, draw };
};
export default loadThree;

async function loadSplats(url: string, fileName: string): Promise<THREE.Object3D> {
  const end = fileName.replace(/^.*\./, '').toLowerCase();
  if (end in GEOMETRY_LOADERS) {
    const Loader = GEOMETRY_LOADERS[end as keyof typeof GEOMETRY_LOADERS];
    return new GaussianSplat(await new Loader().loadAsync(url));
  }
  const loader = new GLTFLoader().register((parser) => new GLTFGaussianSplatLoaderExtension(parser));
  return (await loader.loadAsync(url)).scene;
}
