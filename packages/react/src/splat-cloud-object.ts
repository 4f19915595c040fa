import { getRootState, type ThreeElement } from '@react-three/fiber';
import { SplatCloudObject as ObjectOfThree, type SplatHit } from '@websplatter/three';
import type { Camera, WebGPURenderer } from 'three/webgpu';
import { rendererOf } from './use-renderer.ts';

/** The object of a `<Splats>`: a SplatCloudObject of @websplatter/three that knows its Canvas. */
export class SplatCloudObject extends ObjectOfThree {
  /**
   * Returns the splat that contributes most to a pixel of the last frame from the Canvas's camera;
   * null if there is none, or if it belongs to another cloud.
   *
   * @param x, y CSS pixels from the canvas's top left, as `offsetX` and `offsetY` of its pointer
   *   events are.
   */
  override pick(x: number, y: number): Promise<SplatHit | null>;
  /** Picks from the last frame of any renderer and camera, in physical pixels. */
  override pick(renderer: WebGPURenderer, camera: Camera, xPx: number, yPx: number): Promise<SplatHit | null>;
  override pick(
    ...place: [number, number] | [WebGPURenderer, Camera, number, number]
  ): Promise<SplatHit | null> {
    if (place.length === 4) return super.pick(...place);
    const state = getRootState(this);
    // Unmounted: in no Canvas, and in no frame.
    if (!state) return Promise.resolve(null);
    const renderer = rendererOf(state) as WebGPURenderer;
    const [xPx, yPx] = place.map((distance) => Math.floor(distance * renderer.getPixelRatio()));
    return super.pick(renderer, state.camera, xPx, yPx);
  }
}

declare module '@react-three/fiber' {
  interface ThreeElements {
    /** After `extend({ SplatCloudObject })`. */
    splatCloudObject: ThreeElement<typeof SplatCloudObject>;
  }
}
