/**
 * A plugin for three's GLTFLoader that loads splats in glTF files.
 *
 * @module
 */
import type { SplatData } from '@websplatter/three';
import { SplatGltfPlugin as PluginOfThree } from '@websplatter/three/gltf';
import { SplatCloudObject } from './splat-cloud-object.ts';

export type { GltfParser } from '@websplatter/three/gltf';

/**
 * Shows the splats of glTF files (KHR_gaussian_splatting) that three's GLTFLoader loads. Each mesh
 * with splats becomes a `SplatCloudObject` of @websplatter/react in the scene, or a Group if it also
 * has other geometry. Supports the same extensions as core's reader of glTF.
 *
 * Loads reject with the errors of `SplatLoader.load`.
 *
 * @example
 * import { useLoader } from '@react-three/fiber';
 * import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
 *
 * function Room() {
 *   const { scene } = useLoader(GLTFLoader, '/room.glb', (loader) => {
 *     loader.register((parser) => new SplatGltfPlugin(parser));
 *   });
 *   return <primitive object={scene} />;
 * }
 */
export class SplatGltfPlugin extends PluginOfThree {
  protected override makeCloud(data: SplatData): SplatCloudObject {
    return new SplatCloudObject(data);
  }
}
