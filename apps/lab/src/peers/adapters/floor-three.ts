import * as THREE from 'three/webgpu';
import { fetchAway, type LoadPeer, type PeerFormats } from '../adapter.ts';
import { threeOptions, threeScene } from './three-scene.ts';

export const formats: PeerFormats = 'any';

/** A frame of three's WebGPURenderer without splats; options as of `websplatter-three`. */
const loadFloorThree: LoadPeer = async ({ canvas, url, options }) => {
  const renderer = new THREE.WebGPURenderer({ canvas, ...threeOptions(options) });
  await renderer.init();
  const { setCamera, draw } = threeScene(renderer, canvas, options);
  await fetchAway(url);
  return { note: `fetches the file; WebGPURenderer r${THREE.REVISION} without splats`, setCamera, draw };
};
export default loadFloorThree;
