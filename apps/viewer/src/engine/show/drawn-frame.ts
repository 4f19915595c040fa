import type { Camera, Detail, FrameRequest, SplatEngine, TextureImage } from '@websplatter/core';
import type { Vec3 } from '../../state/vec3.ts';
import type { ShownScene } from '../open/shown-scene.ts';

/** A frame, and the scene that it shows. */
export interface DrawnFrame {
  readonly scene: ShownScene;
  /** The request without its accuracy. */
  readonly frame: FrameRequest & { readonly background: Vec3; readonly detail: Detail };
  /** The camera as if no panel covered the picture. */
  readonly centred: Camera;
  /** Whether the scene is the other way up. */
  readonly isFlipped: boolean;
}

/** The frame on the screen, and the engine that can draw variations of it. */
export interface ShownFrame {
  readonly engine: SplatEngine;
  /** The request without its accuracy. */
  readonly frame: FrameRequest;
  /** The request with the camera as if no panel covered the picture, for saving it. */
  readonly centred: FrameRequest;
  /** Whether the scene is the other way up. */
  readonly isFlipped: boolean;
}

/** An image read back without its background, and the background shown behind it. */
export interface ImageOnBackground {
  readonly image: TextureImage;
  readonly background: Vec3;
}

/** Key of an image: all that it depends on except accuracy, background and covering panels. */
export function imageKey({ scene, frame, centred }: DrawnFrame): string {
  const { clouds, widthPx, heightPx, detail } = frame;
  const models = clouds.map(({ modelMatrix }) => modelMatrix && Array.from(modelMatrix));
  const parts = scene.parts.map(({ key, look, loaded }) => [key, look.isHidden, look.opacity, loaded.frame]);
  const effects = clouds.map((cloud) =>
    cloud.effects?.map(({ effect, options, selection, reason }) => [
      effect.name,
      options,
      selection?.version,
      reason,
    ]),
  );
  const { viewMatrix, projectionMatrix } = centred;
  const matrices = [Array.from(viewMatrix), Array.from(projectionMatrix), models];
  return JSON.stringify([scene.id, widthPx, heightPx, detail, matrices, parts, effects]);
}
