/**
 * A plugin for three's GLTFLoader that loads splats in glTF files.
 *
 * @module
 */
export { type GltfParser, SplatGltfPlugin } from './cloud/gltf-plugin.ts';
