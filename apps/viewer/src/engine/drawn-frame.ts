import type { Camera, Detail, FrameRequest, SplatEngine, TextureImage } from '@websplatter/core';
import type { Vec3 } from '../state/vec3.ts';
import type { ShownScene } from './shown-scene.ts';

/** The frame that was drawn last, and the scene that it shows. */
export interface DrawnFrame {
  readonly scene: ShownScene;
  /** Everything but its accuracy. */
  readonly frame: FrameRequest & { readonly background: Vec3; readonly detail: Detail };
  /** Its camera where no panel covers the picture. */
  readonly centred: Camera;
}

/** The frame on the screen, and the engine that can draw others like it. */
export interface ShownFrame {
  readonly engine: SplatEngine;
  /** Without accuracy. */
  readonly frame: FrameRequest;
  /** The same with no panel over the picture, for saving it. */
  readonly centred: FrameRequest;
}

/** An image as read back, without its background, and the background that it is shown on. */
export interface ImageOnBackground {
  readonly image: TextureImage;
  readonly background: Vec3;
}

/** All that an image depends on but accuracy, background and panels that cover it, as text. */
export function imageKey({ scene, frame, centred }: DrawnFrame): string {
  const { clouds, widthPx, heightPx, detail } = frame;
  const models = clouds.map(({ modelMatrix }) => modelMatrix && Array.from(modelMatrix));
  const parts = scene.parts.map(({ key, look }) => [key, look.isHidden, look.opacity]);
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
