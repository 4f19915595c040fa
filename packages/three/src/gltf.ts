/** Splats in glTF files that three's GLTFLoader loads (`@websplatter/three/gltf`). */
export { type GltfParser, SplatGltfPlugin } from './gltf-plugin.ts';
