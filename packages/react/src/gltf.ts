/** Splats in glTF files (`@websplatter/react/gltf`): the plugin of @websplatter/three/gltf. */
export * from '@websplatter/three/gltf';
