import { createSplatRenderer as create, type SplatRendererParameters } from '@websplatter/three';
import type { WebGPURenderer } from 'three/webgpu';

/**
 * Parameters that a Canvas passes to its `gl`, and further options of `createSplatRenderer` of
 * @websplatter/three.
 */
export interface CanvasRendererParameters extends Omit<SplatRendererParameters, 'canvas' | 'context'> {
  /** A canvas, as @react-three/fiber types it. */
  readonly canvas?: EventTarget;
}

/**
 * `createSplatRenderer` of @websplatter/three, typed for react-three-fiber's own canvas.
 *
 * @example
 * <Canvas flat gl={createSplatRenderer}>
 *   <Splats src="/garden.spz" />
 * </Canvas>
 */
export const createSplatRenderer = create as (
  parameters?: CanvasRendererParameters,
) => Promise<WebGPURenderer>;
