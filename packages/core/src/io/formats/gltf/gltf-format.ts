import { latin1 } from '../latin1.ts';
import type { SplatFormat } from '../splat-format.ts';

/** Part of every glTF, at any place. 3D Tiles have the same with versions 1. */
const ASSET = /"asset"\s*:\s*\{[^}]*"version"\s*:\s*"2\./;

/** glTF 2.0 with KHR_gaussian_splatting, in one file or with buffers beside it. */
export const gltfFormat: SplatFormat = {
  name: 'gltf',
  title: 'glTF',
  extensions: ['.glb', '.gltf'],
  leadingFile: /\.gltf$/,
  recognise(firstBytes, fileName) {
    const text = latin1(firstBytes);
    if (text.startsWith('glTF')) return true;
    if (!/^(?:\xef\xbb\xbf)?\s*\{/.test(text)) return false;
    return /\.gltf$/i.test(fileName) || ASSET.test(text) || /"(?:accessors|bufferViews|meshes)"/.test(text);
  },
};
