import { createSplatRenderer as create, type SplatRendererParameters } from '@websplatter/three';
import type { WebGPURenderer } from 'three/webgpu';

/** What a Canvas gives its `gl`, and what `createSplatRenderer` of @websplatter/three takes besides. */
export interface CanvasRendererParameters extends Omit<SplatRendererParameters, 'canvas' | 'context'> {
  /** A canvas; @react-three/fiber does not say more of its type than this. */
  readonly canvas?: EventTarget;
}

/** `createSplatRenderer` of @websplatter/three, typed for `<Canvas gl={createSplatRenderer}>`. */
export const createSplatRenderer = create as (
  parameters?: CanvasRendererParameters,
) => Promise<WebGPURenderer>;
