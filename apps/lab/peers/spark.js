import { REVISION } from 'three';
import { sparkScene } from './spark-scene.js';

/** Of SPZ, those in gzip. */
export const formats = ['ply', 'compressed-ply', 'spz 1', 'spz 2', 'spz 3', 'splat', 'ksplat', 'sog'];

/** @type {import('../src/peers/adapter.ts').LoadPeer} */
export default async function loadSpark({ canvas, url, fileName }) {
  const { mesh, peer } = sparkScene(canvas, {}, { url, fileName });
  await mesh.initialized;
  return { note: `WebGLRenderer r${REVISION}, defaults, no levels of detail`, ...peer };
}
