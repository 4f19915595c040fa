/**
 * A plugin for three's GLTFLoader that loads splats in glTF files.
 *
 * @module
 */
export { type GltfParser, SplatGltfPlugin } from './gltf-plugin.ts';
