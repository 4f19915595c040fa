/** Splats in glTF files that three's GLTFLoader loads (`@websplatter/three/gltf`). */
export { SplatGltfPlugin } from './gltf-plugin.ts';
