/**
 * A plugin for three's GLTFLoader that loads splats in glTF files.
 *
 * @module
 */
export * from '@websplatter/three/gltf';
