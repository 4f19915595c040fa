// Code for drawing with an ArrayCamera, as few applications do.
import { cameraIndex, select } from 'three/tsl';
import type { ArrayCamera, Object3D, Scene, WebGPURenderer } from 'three/webgpu';
import { MOST_CAMERAS, openArrayPass as openOf } from '../renderer/array-bridge.ts';
import type { OpenPass } from '../renderer/three-bridge.ts';
import { type Texel, ViewportImage, ViewportMaterial } from './layer-material.ts';

/** The part of a layer that several cameras need. */
export interface ArrayLayer extends Object3D {
  reportDrawing(error: unknown): void;
}

/**
 * As `openPass`, for the cameras of `camera`; `layer` can show an image for each from then on.
 */
export function openArrayPass(
  renderer: WebGPURenderer,
  scene: Scene,
  camera: ArrayCamera,
  layer: ArrayLayer,
): OpenPass | null {
  for (const triangle of [layer, ...layer.children]) {
    const { material } = triangle as Object3D & { readonly material?: object };
    if (material instanceof ViewportMaterial) makeImages(material, camera.cameras.length);
  }
  return openOf(renderer, scene, camera, layer, (error) => layer.reportDrawing(error));
}

/** Makes `material` show an image for each of `count` cameras; one camera keeps its own shader. */
export function makeImages(material: ViewportMaterial, count: number): void {
  const { images } = material;
  // Two at least: three draws for an ArrayCamera only if a material asks for the camera's index.
  const least = Math.min(Math.max(2, count), MOST_CAMERAS);
  if (images.length >= least) return;
  const [first] = images;
  while (images.length < least) images.push(new ViewportImage(first.nothing.clone()));
  const texel = images
    .slice(1)
    .reduce<Texel>(
      (others, image, i) => select(cameraIndex.equal(i + 1), image.texel, others) as unknown as Texel,
      first.texel,
    );
  material.shade(texel);
  material.needsUpdate = true;
}
