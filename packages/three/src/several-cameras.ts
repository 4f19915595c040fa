// What drawing with an ArrayCamera needs; few applications do.
import { cameraIndex, select } from 'three/tsl';
import type { ArrayCamera, Mesh, Scene, WebGPURenderer } from 'three/webgpu';
import { MOST_CAMERAS, openArrayPass as openOf } from './array-bridge.ts';
import { imageSlot, type Texel, type ViewportMaterial } from './layer-material.ts';
import type { OpenPass } from './three-bridge.ts';

/** The part of a layer that several cameras need. */
export interface ArrayLayer extends Mesh {
  reportDrawing(error: unknown): void;
}

/** As `openPass`, for the cameras of `camera`; `layer` can show an image for each from then on. */
export function openArrayPass(
  renderer: WebGPURenderer,
  scene: Scene,
  camera: ArrayCamera,
  layer: ArrayLayer,
): OpenPass | null {
  for (const mesh of [layer, ...layer.children])
    makeSlots((mesh as Mesh).material as ViewportMaterial, camera.cameras.length);
  return openOf(renderer, scene, camera, layer, (error) => layer.reportDrawing(error));
}

/** Makes `material` show an image for each of `count` cameras. It keeps its shader for one camera until several draw. */
export function makeSlots(material: ViewportMaterial, count: number): void {
  const { slots } = material;
  // Two at least: three draws a material for an ArrayCamera only if that asks for the camera's index.
  const least = Math.min(Math.max(2, count), MOST_CAMERAS);
  if (slots.length >= least) return;
  const [first] = slots;
  while (slots.length < least) slots.push(imageSlot(first.nothing.clone(), first.kind));
  const texel = slots
    .slice(1)
    .reduce<Texel>(
      (others, slot, i) => select(cameraIndex.equal(i + 1), slot.texel, others) as unknown as Texel,
      first.texel,
    );
  material.shade(texel);
  material.needsUpdate = true;
}
